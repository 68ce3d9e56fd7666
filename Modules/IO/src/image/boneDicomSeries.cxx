/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomSeries.h"

#include "boneImageIO.h"
#include "boneRefuse.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

/** Images at places nearer than this are at one place, mm. */
constexpr double SamePlace = 1e-3;

double
Height(const DicomHeader & header)
{
  return header.position[0] * header.normal[0] + header.position[1] * header.normal[1] +
         header.position[2] * header.normal[2];
}

/** All images in the folder and the folders in it, in the order of their paths. */
std::vector<DicomHeader>
FindImages(const std::string & folder)
{
  std::set<std::string> paths;
  std::error_code       error;
  const auto            options = fs::directory_options::skip_permission_denied;
  for (auto it = fs::recursive_directory_iterator(folder, options, error); it != fs::recursive_directory_iterator();
       it.increment(error))
  {
    if (it->is_regular_file(error) && IsDicomFile(it->path().string()))
    {
      paths.insert(it->path().string());
    }
  }
  std::vector<DicomHeader> images;
  for (const std::string & path : paths)
  {
    DicomHeader header = ReadWholeDicomFile(path);
    if (header.image)
    {
      images.push_back(std::move(header));
    }
  }
  return images;
}

/** "1 scout", "3 scouts" */
std::string
Count(std::size_t count, const std::string & what)
{
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/** Takes what `passes` says out of the images, and tells of it. */
template <typename TPredicate>
void
PassOver(std::vector<DicomHeader> & images,
         const std::string &        what,
         const TPredicate &         passes,
         std::vector<std::string> & notes)
{
  const auto rest = std::stable_partition(images.begin(), images.end(), [&](const auto & i) { return !passes(i); });
  const auto count = static_cast<std::size_t>(images.end() - rest);
  if (count > 0)
  {
    notes.push_back(Count(count, what) + " passed over, such as " + rest->path);
  }
  images.erase(rest, images.end());
}

std::vector<DicomSeries>
GroupBySeries(std::vector<DicomHeader> images)
{
  const auto normal = [](const DicomHeader & image, int k) { return std::lround(1e3 * image.normal[k]); };
  using Key = std::tuple<std::string, std::string, int, int, long, long, long>;
  std::map<Key, DicomSeries> series;
  for (DicomHeader & image : images)
  {
    const Key key{ image.number,     image.series,     image.rows,      image.columns,
                   normal(image, 0), normal(image, 1), normal(image, 2) };
    series[key].push_back(std::move(image));
  }
  std::vector<DicomSeries> list;
  for (auto & entry : series)
  {
    auto & slices = entry.second;
    std::stable_sort(
      slices.begin(), slices.end(), [](const auto & a, const auto & b) { return Height(a) < Height(b); });
    list.push_back(std::move(slices));
  }
  return list;
}

bool
IsVolume(const DicomSeries & series)
{
  return series.size() > 1 || series.front().frames > 1;
}

std::string
Describe(const DicomSeries & series)
{
  const DicomHeader & first = series.front();
  const bool          frames = series.size() == 1 && first.frames > 1;
  std::string         name = first.number.empty() ? first.series : "number " + first.number;
  name += " (" + first.modality + (first.description.empty() ? "" : ", '" + first.description + "'") + ", ";
  return name + Count(frames ? static_cast<std::size_t>(first.frames) : series.size(), "slice") +
         Say(" of ", first.columns, " x ", first.rows, ")");
}

std::string
List(const std::vector<DicomSeries> & series)
{
  constexpr std::size_t most = 20;
  std::string           text;
  for (std::size_t i = 0; i < std::min(most, series.size()); ++i)
  {
    text += (i > 0 ? ", " : "") + Describe(series[i]);
  }
  return text + (series.size() > most ? ", ..." : "");
}

/** Those that `wanted` names, or that are volumes where it is empty; those that are not are told of. */
std::vector<DicomSeries>
Choose(std::vector<DicomSeries>   all,
       const std::string &        folder,
       const std::string &        wanted,
       std::vector<std::string> & notes)
{
  const auto named = [&wanted](const DicomSeries & series) {
    const DicomHeader & first = series.front();
    return first.number == wanted || first.series == wanted || first.description == wanted;
  };
  std::vector<DicomSeries> chosen;
  std::copy_if(all.begin(), all.end(), std::back_inserter(chosen), [&](const DicomSeries & series) {
    return wanted.empty() || named(series);
  });
  if (chosen.empty())
  {
    throw IOError(folder, "has no DICOM series '" + wanted + "'; it has " + List(all));
  }
  const auto singles = std::stable_partition(chosen.begin(), chosen.end(), IsVolume);
  if (singles == chosen.begin())
  {
    throw IOError(folder,
                  chosen.size() == 1 ? "holds a DICOM series of one slice where a volume is needed"
                                     : "holds single DICOM images where a volume is needed: " + List(chosen));
  }
  for (auto single = singles; single != chosen.end(); ++single)
  {
    notes.push_back("a single image passed over, " + single->front().path);
  }
  chosen.erase(singles, chosen.end());
  return chosen;
}

/** Takes out files that are copies of another, and refuses different images at one place. */
void
DropCopies(DicomSeries & series, const std::string & folder, std::vector<std::string> & notes)
{
  std::set<std::string> instances;
  PassOver(
    series,
    "copied file",
    [&instances](const DicomHeader & image) {
      return !image.instance.empty() && !instances.insert(image.instance).second;
    },
    notes);
  for (std::size_t i = 1; i < series.size(); ++i)
  {
    const double between = Height(series[i]) - Height(series[i - 1]);
    if (between < SamePlace)
    {
      throw IOError(
        folder,
        "has two DICOM images at one place, " + series[i - 1].path + " and " + series[i].path +
          ": is one a duplicate, or are there several phases? Put the slices of one volume into a folder of "
          "their own");
    }
  }
}
} // namespace

DicomSeries
FindDicomSeries(const std::string & folder, const std::string & wanted, std::vector<std::string> & notes)
{
  std::vector<DicomHeader> images = FindImages(folder);
  if (images.empty())
  {
    throw IOError(folder, "is a folder without a DICOM series");
  }
  PassOver(
    images, "scout", [](const DicomHeader & image) { return image.scout; }, notes);
  PassOver(
    images, "unplaced image", [](const DicomHeader & image) { return !image.placed && image.frames <= 1; }, notes);
  if (images.empty())
  {
    throw IOError(folder,
                  "holds no DICOM slice with a position (0020,0032) and an orientation (0020,0037) that is no scout");
  }
  std::vector<DicomSeries> chosen = Choose(GroupBySeries(std::move(images)), folder, wanted, notes);
  if (chosen.size() > 1)
  {
    throw SeveralSeries(
      folder,
      Say("holds ", chosen.size(), " DICOM series ", wanted.empty() ? "" : "of that name ", "- ", List(chosen)));
  }
  DropCopies(chosen.front(), folder, notes);
  return chosen.front();
}
} // namespace bone
