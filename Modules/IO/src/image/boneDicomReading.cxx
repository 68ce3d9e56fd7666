/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomSeries.h"
#include "boneImageFile.h"
#include "boneRefuse.h"

#include <itkGDCMImageIO.h>
#include <itkImageSeriesReader.h>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
// Not Eigen's: the headers included here bring an older Eigen of ITK's own.
using Vector = itk::Vector<double, 3>;

// How far a slice may lie from its place on an even grid, as part of the spacing.
constexpr double PositionTolerance = 0.05;

void
RequireEvenSpacing(const DicomSeries & series, const CTImage * image, const std::string & folder)
{
  Vector normal;
  for (int k = 0; k < 3; ++k)
  {
    normal[k] = image->GetDirection()[k][2];
  }
  const Vector first(series.front().position.data());
  const double length = (Vector(series.back().position.data()) - first) * normal;
  const double step = length / static_cast<double>(series.size() - 1);
  double       worst = 0, drift = 0;
  for (std::size_t i = 0; i < series.size(); ++i)
  {
    const Vector offset = Vector(series[i].position.data()) - first;
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
ReadDicomFolder(const std::string & folder, const std::string & wanted, std::vector<std::string> & notes)
{
  const DicomSeries series = FindDicomSeries(folder, wanted, notes);
  if (series.size() == 1)
  {
    return ReadCT(series.front().path); // of several frames
  }
  std::vector<std::string> files;
  std::transform(
    series.begin(), series.end(), std::back_inserter(files), [](const DicomHeader & slice) { return slice.path; });
  auto reader = itk::ImageSeriesReader<CTImage>::New();
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(files);
  try
  {
    reader->Update();
  }
  catch (const itk::ExceptionObject &)
  {
    throw IOError(folder,
                  "is no readable DICOM series: its slices differ in size or place, or are compressed in a way that is "
                  "not known");
  }
  CTImage::Pointer image = reader->GetOutput();
  RequireEvenSpacing(series, image, folder);
  image->DisconnectPipeline();
  return image;
}
} // namespace bone
