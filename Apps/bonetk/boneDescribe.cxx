/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDescribe.h"

#include "boneDensityEvaluation.h"
#include "boneLabelChoice.h"
#include "boneLabelValue.h"
#include "boneQualityMeasures.h"

#include <itkImageRegionConstIterator.h>
#include <itkMath.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <map>
#include <sstream>

namespace bone
{
namespace
{
/** A row "name    value" with the values in a column. */
template <typename TValue>
void
Row(std::ostream & os, const std::string & name, const TValue & value)
{
  os << std::left << std::setw(28) << name << value << '\n';
}

std::string
Numbers(const Vector3 & v)
{
  std::ostringstream os;
  os << std::setprecision(6) << v.x() << ' ' << v.y() << ' ' << v.z();
  return os.str();
}

std::string
Angles(const QualitySummary & summary)
{
  std::ostringstream os;
  const double       degrees = 180.0 / itk::Math::pi;
  os << std::fixed << std::setprecision(1) << "least " << summary.minimum * degrees << ", 1st percentile "
     << summary.percentile1 * degrees << ", mean " << summary.mean * degrees << " degrees";
  return os.str();
}

void
DescribeGrid(const itk::ImageBase<3> & image, std::ostream & os)
{
  const auto size = image.GetLargestPossibleRegion().GetSize();
  const auto spacing = image.GetSpacing();
  const auto origin = image.GetOrigin();
  os << std::left << std::setw(28) << "voxels" << size[0] << " x " << size[1] << " x " << size[2] << '\n';
  Row(os, "spacing (mm)", Numbers({ spacing[0], spacing[1], spacing[2] }));
  Row(os, "origin (mm, LPS)", Numbers({ origin[0], origin[1], origin[2] }));
  for (unsigned int axis = 0; axis < 3; ++axis)
  {
    const auto & d = image.GetDirection();
    Row(os, "axis " + std::to_string(axis) + " (LPS)", Numbers({ d(0, axis), d(1, axis), d(2, axis) }));
  }
}

void
DescribeLabels(const std::vector<LabelCount> & labels, std::ostream & os)
{
  for (const LabelCount & label : labels)
  {
    std::ostringstream text;
    text << label.voxels << " voxels, " << std::fixed << std::setprecision(1) << 1e-3 * label.volume << " cm^3"
         << (label.name.empty() ? "" : ", " + label.name);
    Row(os, "label " + std::to_string(label.value), text.str());
  }
}

/** The labels of an image, where its values are few and whole; else none. */
std::vector<LabelCount>
FindLabels(const CTImage & image, const std::vector<LabelName> & names)
{
  constexpr std::size_t        most = 256;
  std::map<float, std::size_t> counts;
  for (itk::ImageRegionConstIterator<CTImage> it(&image, image.GetLargestPossibleRegion()); !it.IsAtEnd(); ++it)
  {
    ++counts[it.Get()];
    if (counts.size() > most || it.Get() != std::floor(it.Get()))
    {
      return {};
    }
  }
  const auto spacing = image.GetSpacing();
  counts.erase(0.0F);
  std::vector<LabelCount> labels;
  for (const auto & [value, voxels] : counts)
  {
    const auto label = static_cast<int>(value);
    const auto named =
      std::find_if(names.begin(), names.end(), [label](const LabelName & name) { return name.value == label; });
    labels.push_back({ label,
                       voxels,
                       spacing[0] * spacing[1] * spacing[2] * static_cast<double>(voxels),
                       named == names.end() ? "" : named->name });
  }
  return labels;
}
} // namespace

std::string
DescribeQuality(const MeshArrays & mesh)
{
  std::ostringstream os;
  Row(os, "smallest dihedral angle", Angles(SummarizeQuality(mesh, QualityMeasure::MinimumDihedralAngle)));
  const QualitySummary ratio = SummarizeQuality(mesh, QualityMeasure::RadiusRatio);
  os << std::left << std::setw(28) << "radius ratio" << std::fixed << std::setprecision(3) << "least " << ratio.minimum
     << ", mean " << ratio.mean << '\n';
  return os.str();
}

std::string
DescribeMesh(const MeshArrays & mesh)
{
  std::ostringstream os;
  Row(os, "kind", "tetrahedral density mesh");
  Row(os, "points", mesh.points.size());
  Row(os, "tetrahedra", mesh.tetrahedra.size());
  std::map<int, std::pair<std::size_t, double>> regions;
  double                                        volume = 0.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 &  cell = mesh.tetrahedra[t];
    const double v =
      SignedVolume(mesh.points[cell[0]], mesh.points[cell[1]], mesh.points[cell[2]], mesh.points[cell[3]]);
    volume += v;
    if (!mesh.region.empty())
    {
      auto & region = regions[mesh.region[t]];
      ++region.first;
      region.second += v;
    }
  }
  os << std::fixed << std::setprecision(1);
  Row(os, "volume (mm^3)", volume);
  for (const auto & [region, content] : regions)
  {
    os << std::left << std::setw(28) << "region " + std::to_string(region) << RegionName(region) << ", "
       << content.first << " tetrahedra, " << content.second << " mm^3\n";
  }
  if (mesh.HasDensity())
  {
    Row(os, "density", "degree " + std::to_string(mesh.maximumDegree) + ", " + DensityQuantityName(mesh.quantity));
  }
  else
  {
    Row(os, "density", "none");
  }
  return os.str() + DescribeQuality(mesh);
}

std::string
DescribeContours(const ContourStack & stack)
{
  std::map<int, std::size_t> closed;
  std::size_t                axes = 0;
  std::size_t                points = 0;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      points += contour.points.size();
      axes += contour.axis ? 1 : 0;
      closed[contour.layer] += contour.axis ? 0 : 1;
    }
  }
  std::ostringstream os;
  Row(os, "kind", "contours");
  Row(os, "slices", stack.GetSlices().size());
  Row(os, "normal", Numbers(stack.GetNormal()));
  if (!stack.GetSlices().empty())
  {
    const std::size_t last = stack.GetSlices().size() - 1;
    os << std::left << std::setw(28) << "heights (mm)" << stack.GetHeight(0) << " to " << stack.GetHeight(last) << '\n';
  }
  for (const auto & [layer, count] : closed)
  {
    if (count > 0)
    {
      Row(os, "closed, layer " + std::to_string(layer), count);
    }
  }
  Row(os, "medial-axis lines", axes);
  Row(os, "points", points);
  Row(os, "goes on beyond the image", stack.GetOpenStart() || stack.GetOpenEnd() ? "yes" : "no");
  return os.str();
}

std::string
DescribeHierarchy(const DensityHierarchy<> & hierarchy)
{
  std::ostringstream os;
  Row(os, "kind", "hierarchy");
  for (std::size_t i = 0; i < hierarchy.GetNumberOfLevels(); ++i)
  {
    const auto & level = hierarchy.GetLevels()[i];
    os << std::left << std::setw(28) << "level " + std::to_string(i + 1) << level.mesh->GetNumberOfTetrahedra()
       << " tetrahedra, " << level.mesh->GetNumberOfPoints() << " points, density error " << level.densityError
       << " (rms to level 1), surface error " << level.surfaceError << " mm\n";
  }
  return os.str();
}

std::string
DescribeView(const XRayGeometry & geometry)
{
  const XRayGeometry::View & view = geometry.GetView();
  std::ostringstream         os;
  Row(os, "kind", view.parallel ? "X-ray view, parallel beam" : "X-ray view, point source");
  Row(os, view.parallel ? "direction" : "source (mm)", Numbers(view.parallel ? view.direction : view.source));
  Row(os, "detector origin (mm)", Numbers(view.detectorOrigin));
  Row(os, "detector U", Numbers(view.detectorU));
  Row(os, "detector V", Numbers(view.detectorV));
  os << std::left << std::setw(28) << "pixels" << view.size[0] << " x " << view.size[1] << " of " << view.spacing.x()
     << " x " << view.spacing.y() << " mm\n";
  return os.str();
}

std::string
DescribeImage(const CTImage & image, const std::vector<LabelName> & names)
{
  std::ostringstream os;
  Row(os, "kind", "image");
  DescribeGrid(image, os);
  float  least = std::numeric_limits<float>::max();
  float  largest = std::numeric_limits<float>::lowest();
  double sum = 0.0;
  for (itk::ImageRegionConstIterator<CTImage> it(&image, image.GetLargestPossibleRegion()); !it.IsAtEnd(); ++it)
  {
    least = std::min(least, it.Get());
    largest = std::max(largest, it.Get());
    sum += it.Get();
  }
  os << std::left << std::setw(28) << "values" << least << " to " << largest << ", mean "
     << sum / static_cast<double>(image.GetLargestPossibleRegion().GetNumberOfPixels()) << '\n';
  DescribeLabels(FindLabels(image, names), os);
  if (StatesOneBone(image))
  {
    Row(os, "labels are", "regions of one bone");
  }
  return os.str();
}

std::string
DescribeLabelFile(const LabelFile & file)
{
  std::ostringstream os;
  Row(
    os, "kind", "segments in " + std::to_string(file.layers.size()) + (file.layers.size() == 1 ? " layer" : " layers"));
  DescribeGrid(*file.layers.front(), os);
  DescribeLabels(CountLabels(file), os);
  return os.str();
}

std::string
DescribeModel(const StatisticalModel & model)
{
  const auto &       content = model.GetContent();
  std::ostringstream os;
  Row(os, "kind", "statistical model");
  Row(os, "subjects", content.subjects.size());
  Row(os, "points", content.mean.points.size());
  Row(os, "tetrahedra", content.mean.tetrahedra.size());
  Row(os, "size", content.similarity ? "taken out" : "in the shape modes");
  if (model.HasDensity())
  {
    Row(os,
        "density",
        "degree " + std::to_string(content.mean.maximumDegree) + ", " + DensityQuantityName(content.mean.quantity));
  }
  const auto modes =
    [&os](const std::string & name, const PrincipalModes & principal, double per, const std::string & unit) {
      Row(os, name + " modes", principal.GetNumberOfModes());
      double explained = 0;
      for (Eigen::Index k = 0; k < std::min<Eigen::Index>(principal.GetNumberOfModes(), 10); ++k)
      {
        explained += principal.variances[k];
        std::ostringstream line;
        line << std::setprecision(4) << std::sqrt(principal.variances[k] / per) << ' ' << unit << ", "
             << 100 * explained / principal.totalVariance << " % with those before";
        Row(os, "  " + name + ' ' + std::to_string(k + 1), line.str());
      }
    };
  modes("shape", content.shape, static_cast<double>(content.mean.points.size()), "mm (root mean square of points)");
  if (model.HasDensity())
  {
    const bool   byVolume = content.density.weights.size() > 0;
    const auto   cells = static_cast<double>(content.mean.tetrahedra.size());
    const double per = byVolume ? cells : static_cast<double>(content.density.GetDimension());
    modes("density",
          content.density,
          per,
          byVolume ? "(root mean square over the bone)" : "(root mean square of coefficients)");
  }
  if (model.IsCombined())
  {
    Row(os, "combined modes", content.combined.variances.size());
  }
  return os.str();
}
} // namespace bone
