/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSformImageIO.h"

#include "boneGzFile.h"
#include "boneImageHeader.h"

#include <itkMetaDataObject.h>
#include <itkNiftiImageIO.h>

#include <Eigen/Dense>

#include <array>
#include <cstdint>
#include <optional>

namespace bone
{
namespace
{
constexpr double LargestCosine = 1e-3;
constexpr double LargestShift = 0.1; // of a voxel

/** What a header says, in LPS and mm. */
struct SformHeader
{
  Eigen::Matrix3d axes;
  Eigen::Vector3d spacing;
  Eigen::Vector3d origin;
  std::string     description;
  std::string     auxiliaryFile;
};

double
MillimetresOf(int units)
{
  constexpr int metre = 1;
  constexpr int micrometre = 3;
  return units == metre ? 1e3 : units == micrometre ? 1e-3 : 1.0;
}

/** Offsets as in nifti1.h. */
std::optional<SformHeader>
ReadSform(const std::string & path)
{
  std::array<char, 348> raw;
  const GzFile          file = OpenGz(path);
  if (!file || gzread(file.get(), raw.data(), raw.size()) != static_cast<int>(raw.size()))
  {
    return std::nullopt;
  }
  const auto dimensions = Decode<std::int16_t>(&raw[40], false);
  const bool swapped = dimensions < 1 || dimensions > 7;
  if (Decode<std::int32_t>(&raw[0], swapped) != 348 || Decode<std::int16_t>(&raw[40], swapped) < 3 ||
      Decode<std::int16_t>(&raw[254], swapped) <= 0)
  {
    return std::nullopt;
  }
  Eigen::Matrix<double, 3, 4> affine;
  Eigen::Vector3d             steps;
  for (int row = 0; row < 3; ++row)
  {
    steps[row] = Decode<std::int16_t>(&raw[42 + 2 * row], swapped) - 1.0;
    for (int column = 0; column < 4; ++column)
    {
      affine(row, column) = Decode<float>(&raw[280 + 16 * row + 4 * column], swapped);
    }
  }
  affine.topRows<2>() *= -1.0; // from RAS to LPS
  affine *= MillimetresOf(raw[123] & 7);
  SformHeader header;
  header.spacing = affine.leftCols<3>().colwise().norm();
  if (!(header.spacing.minCoeff() > 0.0))
  {
    return std::nullopt;
  }
  const Eigen::Matrix3d units = affine.leftCols<3>() * header.spacing.cwiseInverse().asDiagonal();
  // The rotation (and reflection) that is nearest.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(units, Eigen::ComputeFullU | Eigen::ComputeFullV);
  header.axes = svd.matrixU() * svd.matrixV().transpose();
  const Eigen::Matrix3d products = units.transpose() * units - Eigen::Matrix3d::Identity();
  const Eigen::Vector3d shift = ((units - header.axes).cwiseAbs() * header.spacing.cwiseProduct(steps));
  if (!(products.cwiseAbs().maxCoeff() <= LargestCosine) ||
      !(shift.maxCoeff() <= LargestShift * header.spacing.minCoeff()))
  {
    return std::nullopt;
  }
  header.origin = affine.col(3);
  header.description.assign(&raw[148], strnlen(&raw[148], 80));
  header.auxiliaryFile.assign(&raw[228], strnlen(&raw[228], 24));
  return header;
}

class SformImageIO : public itk::NiftiImageIO
{
public:
  using Self = SformImageIO;
  using Superclass = itk::NiftiImageIO;
  using Pointer = itk::SmartPointer<Self>;

  itkFactorylessNewMacro(Self);

  void
  ReadImageInformation() override
  {
    if (m_IsRead) // ImageFileReader asks again
    {
      return;
    }
    try
    {
      Superclass::ReadImageInformation();
    }
    catch (const itk::ExceptionObject & error)
    {
      // What comes before the position is read by then; the rest follows here.
      if (std::string(error.GetDescription()).find("orthonormal") == std::string::npos)
      {
        throw;
      }
    }
    for (unsigned int d = 0; d < 3; ++d)
    {
      this->SetSpacing(d, m_Header.spacing[d]);
      this->SetOrigin(d, m_Header.origin[d]);
      std::vector<double> axis(this->GetNumberOfDimensions(), 0.0);
      std::copy_n(m_Header.axes.col(d).data(), 3, axis.begin());
      this->SetDirection(d, axis);
    }
    auto & notes = this->GetMetaDataDictionary();
    itk::EncapsulateMetaData<std::string>(notes, "descrip", m_Header.description);
    itk::EncapsulateMetaData<std::string>(notes, "aux_file", m_Header.auxiliaryFile);
    m_IsRead = true;
  }

  void
  SetHeader(const SformHeader & header)
  {
    m_Header = header;
  }

private:
  SformHeader m_Header;
  bool        m_IsRead{ false };
};
} // namespace

itk::ImageIOBase::Pointer
OpenBySform(const std::string & path)
{
  const auto header = ReadSform(path);
  if (!header)
  {
    return nullptr;
  }
  const auto io = SformImageIO::New();
  io->SetHeader(*header);
  io->SetFileName(path);
  io->ReadImageInformation();
  return io.GetPointer();
}
} // namespace bone
