/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen
#include <itkEuler3DTransform.h>
#include <itkTransformFactoryBase.h>
#include <itkTransformFileWriter.h>

#include "boneTransformIO.h"

#include "boneAtomicFile.h"
#include "boneIOError.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

namespace bone
{
namespace
{
constexpr std::uintmax_t LargestTransformFile = 1 << 20; ///< one has some 300 bytes

constexpr double LargestTransformNumber = 1e6; ///< mm or radians

using AnyTransform = itk::TransformBaseTemplate<double>;

/** The words behind "NAME:" in the one line that begins so. */
std::vector<std::string>
WordsOfLine(const std::vector<std::string> & lines, const std::string & name)
{
  const std::string        heading = name + ':';
  std::vector<std::string> words;
  int                      count = 0;
  for (const std::string & line : lines)
  {
    if (line.rfind(heading, 0) == 0)
    {
      std::istringstream stream(line.substr(heading.size()));
      words.assign(std::istream_iterator<std::string>(stream), {});
      ++count;
    }
  }
  if (name == "Transform" && count > 1)
  {
    Refuse("holds ", count, " transforms; give a file of one rigid transform");
  }
  if (count != 1)
  {
    Refuse("is no ITK transform file: it has ",
           count == 0 ? "no line" : "more than one line",
           " that begins with ",
           heading);
  }
  return words;
}

AnyTransform::ParametersType
NumbersOfLine(const std::vector<std::string> & lines, const std::string & name)
{
  const auto                   words = WordsOfLine(lines, name);
  AnyTransform::ParametersType numbers(static_cast<itk::SizeValueType>(words.size()));
  for (std::size_t i = 0; i < words.size(); ++i)
  {
    char * end = nullptr;
    numbers[static_cast<itk::SizeValueType>(i)] = std::strtod(words[i].c_str(), &end);
    if (*end != '\0' || !std::isfinite(numbers[static_cast<itk::SizeValueType>(i)]))
    {
      Refuse("has among its ", name, " something that is no number");
    }
    if (!(std::abs(numbers[static_cast<itk::SizeValueType>(i)]) < LargestTransformNumber))
    {
      Refuse("has among its ", name, " ", words[i], ", which no rigid transform of a bone has");
    }
  }
  return numbers;
}

/** A transform of the class that ITK's files call so, "Euler3DTransform_double_3_3". */
AnyTransform::Pointer
MakeTransform(std::string name)
{
  if (const std::size_t type = name.find("_float_"); type != std::string::npos)
  {
    name.replace(type, std::strlen("_float_"), "_double_");
  }
  itk::TransformFactoryBase::RegisterDefaultTransforms();
  const itk::LightObject::Pointer made = itk::ObjectFactoryBase::CreateInstance(name.c_str());
  if (made.IsNotNull())
  {
    made->UnRegister(); // CreateInstance counts one reference more than it gives
  }
  const AnyTransform::Pointer transform = dynamic_cast<AnyTransform *>(made.GetPointer());
  if (transform.IsNull())
  {
    Refuse("has a transform that is not known");
  }
  return transform;
}

/** ITK's own reader of these files does not see where parameters are missing. */
AnyTransform::Pointer
ReadOneTransform(const std::string & path)
{
  RequireReadableFile(path);
  RequireExtension(path, { ".tfm", ".txt" });
  if (std::filesystem::file_size(path) > LargestTransformFile)
  {
    Refuse("is no transform file: it has more than a megabyte");
  }
  std::ifstream            file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);)
  {
    lines.push_back(line);
  }
  const auto name = WordsOfLine(lines, "Transform");
  const auto transform = MakeTransform(name.empty() ? "" : name.front());
  const auto fixed = NumbersOfLine(lines, "FixedParameters");
  const auto values = NumbersOfLine(lines, "Parameters");
  // An Euler3DTransform's fixed parameters have one that older files lack.
  const auto fixedCount = transform->GetFixedParameters().size();
  if (fixed.size() > fixedCount || fixed.size() < std::min<std::size_t>(fixedCount, 3))
  {
    Refuse("has ", fixed.size(), " FixedParameters, where its transform needs ", fixedCount);
  }
  const auto count = transform->GetNumberOfParameters();
  if (values.size() != count)
  {
    Refuse("has ", values.size(), " Parameters, where its transform needs ", count);
  }
  try
  {
    transform->SetFixedParameters(fixed);
    transform->SetParameters(values);
  }
  catch (const itk::ExceptionObject &)
  {
    Refuse("has parameters that its transform does not take");
  }
  return transform;
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
    throw MachineError(path, "cannot be written; the disk may be full");
  }
  file.Commit();
}
} // namespace bone
