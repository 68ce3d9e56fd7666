/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomFile.h"
#include "boneImageFile.h"
#include "boneRefuse.h"

#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageSeriesReader.h>
#include <itkMetaDataObject.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace bone
{
namespace
{
using Reader = itk::ImageSeriesReader<CTImage>;
// Not Eigen's: the headers included here bring an older Eigen of ITK's own.
using Vector = itk::Vector<double, 3>;

// How far a slice may lie from its place on an even grid, as part of the spacing.
constexpr double PositionTolerance = 0.05;

void
RequireWholeDicomFiles(const std::string & folder)
{
  std::error_code error;
  for (const auto & entry : std::filesystem::directory_iterator(folder, error))
  {
    if (entry.is_regular_file(error) && IsDicomFile(entry.path().string()))
    {
      RequireWholeDicomFile(entry.path().string());
    }
  }
}

std::vector<std::string>
SeriesFiles(const std::string & folder)
{
  RequireWholeDicomFiles(folder);
  auto names = itk::GDCMSeriesFileNames::New();
  names->SetUseSeriesDetails(true);
  names->SetDirectory(folder);
  const auto series = names->GetSeriesUIDs();
  if (series.empty())
  {
    throw IOError(folder, "is a folder without a DICOM series");
  }
  if (series.size() > 1)
  {
    throw IOError(folder, Say("holds ", series.size(), " DICOM series: put the one to read into a folder of its own"));
  }
  const auto files = names->GetFileNames(series.front());
  if (files.size() < 2)
  {
    throw IOError(folder, "holds a DICOM series of one slice where a volume is needed");
  }
  return files;
}

// ImagePositionPatient of each file, in the order read.
std::vector<Vector>
SlicePositions(Reader * reader, const std::string & folder)
{
  std::vector<Vector> positions;
  for (const auto * dictionary : *reader->GetMetaDataDictionaryArray())
  {
    std::string text;
    itk::ExposeMetaData<std::string>(*dictionary, "0020|0032", text);
    std::replace(text.begin(), text.end(), '\\', ' ');
    std::istringstream stream(text);
    Vector             position;
    if (!(stream >> position[0] >> position[1] >> position[2]))
    {
      throw IOError(folder, "is a DICOM series without slice positions (0020,0032)");
    }
    positions.push_back(position);
  }
  return positions;
}

void
RequireEvenSpacing(const std::vector<Vector> & positions, const CTImage * image, const std::string & folder)
{
  Vector normal;
  for (int k = 0; k < 3; ++k)
  {
    normal[k] = image->GetDirection()[k][2];
  }
  const double length = (positions.back() - positions.front()) * normal;
  const double step = length / static_cast<double>(positions.size() - 1);
  double       worst = 0, drift = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    const Vector offset = positions[i] - positions.front();
    const double height = offset * normal;
    worst = std::max(worst, std::abs(height - static_cast<double>(i) * step));
    drift = std::max(drift, (offset - normal * height).GetNorm());
  }
  const double allowed = PositionTolerance * std::abs(step);
  if (!(worst <= allowed))
  {
    throw IOError(folder,
                  Say("is a DICOM series whose slices are not evenly spaced (up to ",
                      worst,
                      " mm off a spacing of ",
                      std::abs(step),
                      " mm): is one missing?"));
  }
  if (!(drift <= std::max(allowed, 0.5 * image->GetSpacing()[0])))
  {
    throw IOError(folder,
                  Say("is a DICOM series whose slices shift sideways by ",
                      drift,
                      " mm (tilted gantry): resample it to an orthogonal grid"));
  }
}
} // namespace

CTImage::Pointer
ReadDicomSeries(const std::string & folder)
{
  const auto files = SeriesFiles(folder);
  auto       reader = Reader::New();
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(files);
  try
  {
    reader->Update();
  }
  catch (const itk::ExceptionObject & error)
  {
    throw IOError(folder, "is no readable DICOM series: " + ErrorLine(error));
  }
  CTImage::Pointer image = reader->GetOutput();
  RequireEvenSpacing(SlicePositions(reader, folder), image, folder);
  image->DisconnectPipeline();
  return image;
}
} // namespace bone
