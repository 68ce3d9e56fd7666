/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen
#include <itkEuler3DTransform.h>
#include <itkTransformFileReader.h>
#include <itkTransformFileWriter.h>

#include "boneTransformIO.h"

#include "boneAtomicFile.h"
#include "boneIOError.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <cmath>
#include <filesystem>

namespace bone
{
namespace
{
constexpr std::uintmax_t LargestTransformFile = 1 << 20; ///< one has some 300 bytes

itk::TransformBaseTemplate<double>::Pointer
ReadOneTransform(const std::string & path)
{
  RequireReadableFile(path);
  RequireExtension(path, { ".tfm", ".txt" });
  if (std::filesystem::file_size(path) > LargestTransformFile)
  {
    Refuse("is no transform file: it has more than a megabyte");
  }
  auto reader = itk::TransformFileReaderTemplate<double>::New();
  reader->SetFileName(path);
  try
  {
    reader->Update();
  }
  catch (const itk::ExceptionObject &)
  {
    Refuse("is no ITK transform file, or has a transform that is not known");
  }
  const auto * transforms = reader->GetTransformList();
  if (transforms->size() != 1)
  {
    Refuse("holds ", transforms->size(), " transforms; give a file of one rigid transform");
  }
  return transforms->front();
}
} // namespace

itk::SmartPointer<itk::Euler3DTransform<double>>
ReadRigidTransform(const std::string & path)
{
  return NamingFile(path, [&path] {
    using MatrixTransform = itk::MatrixOffsetTransformBase<double, 3, 3>;
    const auto   read = ReadOneTransform(path);
    const auto * affine = dynamic_cast<const MatrixTransform *>(read.GetPointer());
    if (affine == nullptr)
    {
      Refuse("holds a ", read->GetNameOfClass(), ", which is no rigid transform of three dimensions");
    }
    const auto & matrix = affine->GetMatrix();
    for (unsigned int i = 0; i < 3; ++i)
    {
      if (!std::isfinite(affine->GetCenter()[i]) || !(std::abs(affine->GetTranslation()[i]) < 1e6))
      {
        Refuse("has a centre or translation that no bone has");
      }
      for (unsigned int j = 0; j < 3; ++j)
      {
        double product = 0.0;
        for (unsigned int k = 0; k < 3; ++k)
        {
          product += matrix(i, k) * matrix(j, k);
        }
        if (!(std::abs(product - (i == j ? 1.0 : 0.0)) < 1e-5))
        {
          Refuse("has a matrix that is no rotation: it scales or shears");
        }
      }
    }
    if (!(vnl_determinant(matrix.GetVnlMatrix()) > 0.0))
    {
      Refuse("mirrors, and so is no rigid transform");
    }
    auto transform = itk::Euler3DTransform<double>::New();
    transform->SetCenter(affine->GetCenter());
    transform->SetMatrix(matrix, 1e-4);
    transform->SetTranslation(affine->GetTranslation());
    return itk::SmartPointer<itk::Euler3DTransform<double>>(transform);
  });
}

void
WriteRigidTransform(const itk::Euler3DTransform<double> & transform, const std::string & path)
{
  RequireExtension(path, { ".tfm", ".txt" });
  AtomicFile file(path);
  auto       writer = itk::TransformFileWriterTemplate<double>::New();
  writer->SetInput(&transform);
  writer->SetFileName(file.GetTemporaryPath());
  try
  {
    writer->Update();
  }
  catch (const itk::ExceptionObject &)
  {
    throw IOError(path, "cannot be written; the disk may be full");
  }
  file.Commit();
}
} // namespace bone
