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

/** Reads the slices of the region asked for alone. */
class SeriesReader : public itk::ImageSeriesReader<CTImage>
{
public:
  using Self = SeriesReader;
  using Superclass = itk::ImageSeriesReader<CTImage>;
  using Pointer = itk::SmartPointer<Self>;

  itkFactorylessNewMacro(Self);

  void
  SetFolder(const std::string & folder)
  {
    m_Folder = folder;
  }

protected:
  void
  GenerateOutputInformation() override
  {
    this->Read([this] { Superclass::GenerateOutputInformation(); });
  }
  void
  GenerateData() override
  {
    this->Read([this] { Superclass::GenerateData(); });
    RequireFinite(this->GetOutput(), m_Folder);
  }

private:
  template <typename TAction>
  void
  Read(const TAction & action)
  {
    const QuietItk quiet;
    try
    {
      action();
    }
    catch (const itk::ExceptionObject &)
    {
      throw IOError(m_Folder,
                    "is no readable DICOM series: its slices differ in size or place, or are compressed in a way that "
                    "is not known");
    }
  }

  std::string m_Folder;
};
} // namespace

VolumeSource::Pointer
OpenDicomFolder(const std::string &        folder,
                const std::string &        wanted,
                std::vector<std::string> & notes,
                Reading                    reading)
{
  const DicomSeries series = FindDicomSeries(folder, wanted, notes);
  if (series.size() == 1)
  {
    return OpenVolume(series.front().path, "", notes, reading); // of several frames
  }
  std::vector<std::string> files;
  std::transform(
    series.begin(), series.end(), std::back_inserter(files), [](const DicomHeader & slice) { return slice.path; });
  auto reader = SeriesReader::New();
  reader->SetFolder(folder);
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(files);
  reader->MetaDataDictionaryArrayUpdateOff(); // it would be read of all slices
  reader->UpdateOutputInformation();
  RequireEvenSpacing(series, reader->GetOutput(), folder);
  if (reading == Reading::Whole)
  {
    reader->Update();
  }
  else
  {
    reader->GetOutput()->ReleaseDataFlagOn();
  }
  return reader.GetPointer();
}
} // namespace bone
