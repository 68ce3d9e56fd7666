/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStructureSet.h"

#include "boneDicomFile.h"
#include "boneRefuse.h"

#include <gdcmAttribute.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <map>

namespace bone
{
namespace
{
// Coordinates are decimal strings: points this near (mm) are one.
constexpr double SamePoint = 1e-4;

bool
Same(const Vector3 & a, const Vector3 & b)
{
  return (a - b).cwiseAbs().maxCoeff() < SamePoint;
}

std::string
Trimmed(std::string text)
{
  text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

template <uint16_t VGroup, uint16_t VElement>
bool
Has(const gdcm::DataSet & data)
{
  return data.FindDataElement(gdcm::Tag(VGroup, VElement)) &&
         !data.GetDataElement(gdcm::Tag(VGroup, VElement)).IsEmpty();
}

template <uint16_t VGroup, uint16_t VElement>
auto
ValueOf(const gdcm::DataSet & data)
{
  gdcm::Attribute<VGroup, VElement> attribute{};
  if (Has<VGroup, VElement>(data))
  {
    attribute.SetFromDataSet(data);
  }
  return attribute.GetValue();
}

template <uint16_t VGroup, uint16_t VElement>
std::vector<const gdcm::DataSet *>
ItemsOf(const gdcm::DataSet & data, std::vector<gdcm::SmartPointer<gdcm::SequenceOfItems>> & keep)
{
  std::vector<const gdcm::DataSet *> items;
  if (Has<VGroup, VElement>(data))
  {
    keep.push_back(data.GetDataElement(gdcm::Tag(VGroup, VElement)).GetValueAsSQ());
    for (gdcm::SequenceOfItems::SizeType i = 1; keep.back() != nullptr && i <= keep.back()->GetNumberOfItems(); ++i)
    {
      items.push_back(&keep.back()->GetItem(i).GetNestedDataSet());
    }
  }
  return items;
}

// The points of a closed planar contour; none for any other kind.
std::vector<Vector3>
ClosedPlanar(const gdcm::DataSet & item)
{
  std::vector<Vector3> points;
  const std::string    type = Trimmed(ValueOf<0x3006, 0x0042>(item));
  if ((type != "CLOSED_PLANAR" && type != "CLOSEDPLANAR_XOR") || !Has<0x3006, 0x0050>(item))
  {
    return points;
  }
  gdcm::Attribute<0x3006, 0x0050> data;
  data.SetFromDataSet(item);
  for (unsigned int i = 0; i + 2 < data.GetNumberOfValues(); i += 3)
  {
    const Vector3 point(data.GetValue(i), data.GetValue(i + 1), data.GetValue(i + 2));
    RequireSensible(point, i / 3);
    if (points.empty() || !Same(points.back(), point))
    {
      points.push_back(point);
    }
  }
  while (points.size() > 1 && Same(points.front(), points.back()))
  {
    points.pop_back();
  }
  return points;
}

// Removes points that a walk goes to and comes straight back from.
void
RemoveSpikes(std::vector<Vector3> & walk)
{
  for (std::size_t i = 0; i < walk.size() && walk.size() >= 3;)
  {
    const std::size_t n = walk.size();
    const std::size_t next = (i + 1) % n;
    if (Same(walk[(i + n - 1) % n], walk[next]))
    {
      walk.erase(walk.begin() + static_cast<std::ptrdiff_t>(std::max(i, next)));
      walk.erase(walk.begin() + static_cast<std::ptrdiff_t>(std::min(i, next)));
      i = 0;
      continue;
    }
    ++i;
  }
}
} // namespace

std::vector<std::vector<Vector3>>
TakeKeyholesApart(std::vector<Vector3> contour)
{
  RemoveSpikes(contour);
  const std::size_t n = contour.size();
  for (std::size_t i = 0; i + 1 < n; ++i)
  {
    for (std::size_t j = i + 2; j < n; ++j)
    {
      if (Same(contour[i], contour[(j + 1) % n]) && Same(contour[i + 1], contour[j]))
      {
        // The way from i to i + 1 is gone back from j to j + 1: what lies between is a contour of its own.
        const auto at = [&contour](std::size_t k) { return contour.begin() + static_cast<std::ptrdiff_t>(k); };
        std::vector<Vector3> inner(at(i + 1), at(j));
        std::vector<Vector3> outer(at(j + 1 == n ? 1 : 0), at(i + 1)); // i and j + 1 are one point
        outer.insert(outer.end(), at(std::min(n, j + 2)), contour.end());
        auto       parts = TakeKeyholesApart(std::move(outer));
        const auto more = TakeKeyholesApart(std::move(inner));
        parts.insert(parts.end(), more.begin(), more.end());
        return parts;
      }
    }
  }
  return n < 3 ? std::vector<std::vector<Vector3>>() : std::vector<std::vector<Vector3>>{ std::move(contour) };
}

std::vector<Polyline>
ReadStructure(const std::string & path, const std::string & name)
{
  ReadWholeDicomFile(path);
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read())
  {
    Refuse("is no readable DICOM file");
  }
  const gdcm::DataSet & data = reader.GetFile().GetDataSet();
  const std::string     modality = Trimmed(ValueOf<0x0008, 0x0060>(data));
  if (modality != "RTSTRUCT")
  {
    Refuse("is a DICOM file of modality '", modality, "'; contours come as RTSTRUCT");
  }
  std::vector<gdcm::SmartPointer<gdcm::SequenceOfItems>> keep;
  std::map<int, std::string>                             nameOf;
  for (const gdcm::DataSet * item : ItemsOf<0x3006, 0x0020>(data, keep))
  {
    nameOf[ValueOf<0x3006, 0x0022>(*item)] = Trimmed(ValueOf<0x3006, 0x0026>(*item));
  }
  std::map<int, std::vector<Polyline>> structures;
  for (const gdcm::DataSet * item : ItemsOf<0x3006, 0x0039>(data, keep))
  {
    const int number = ValueOf<0x3006, 0x0084>(*item);
    for (const gdcm::DataSet * contour : ItemsOf<0x3006, 0x0040>(*item, keep))
    {
      for (std::vector<Vector3> & part : TakeKeyholesApart(ClosedPlanar(*contour)))
      {
        structures[number].emplace_back();
        structures[number].back().contour.points = std::move(part);
      }
    }
  }
  std::string names;
  const auto  chosen = [&](int number) { return name.empty() || nameOf[number] == name; };
  int         matches = 0;
  for (const auto & entry : structures)
  {
    matches += chosen(entry.first) ? 1 : 0;
    names += (names.empty() ? "'" : ", '") + nameOf[entry.first] + "'";
  }
  if (structures.empty())
  {
    Refuse("holds no closed planar contours");
  }
  if (matches != 1 && name.empty())
  {
    Refuse("holds several structures; choose one of ", names);
  }
  if (matches != 1)
  {
    Refuse("has ", matches, " structures with contours named '", name, "'; there are ", names);
  }
  const auto found =
    std::find_if(structures.begin(), structures.end(), [&](const auto & entry) { return chosen(entry.first); });
  return std::move(found->second);
}
} // namespace bone
