/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "objects.h"

#include "failure.h"

#include <itkCastImageFilter.h>

#include <cctype>

namespace bone::python
{
itk::SmartPointer<ImageBase>
ToImage(const py::object & object)
{
  if (py::isinstance<ImageBase>(object))
  {
    return object.cast<itk::SmartPointer<ImageBase>>();
  }
  return py::module_::import("bonetk.images").attr("as_image")(object).cast<itk::SmartPointer<ImageBase>>();
}

CTImage::Pointer
ToCT(const ImageBase * image)
{
  if (const auto * ct = dynamic_cast<const CTImage *>(image))
  {
    return const_cast<CTImage *>(ct);
  }
  if (const auto * labels = dynamic_cast<const LabelImage *>(image))
  {
    auto cast = itk::CastImageFilter<LabelImage, CTImage>::New();
    cast->SetInput(labels);
    cast->Update();
    return cast->GetOutput();
  }
  throw UsageFailure("an image is missing");
}

LabelImage::Pointer
ToLabels(const ImageBase * image)
{
  if (const auto * labels = dynamic_cast<const LabelImage *>(image))
  {
    return const_cast<LabelImage *>(labels);
  }
  throw UsageFailure(image == nullptr ? "a label map is missing"
                                      : "a label map must hold whole numbers (int16), but this image holds float32");
}

Mesh::Pointer
MakeMesh(MeshArrays arrays)
{
  auto mesh = Mesh::New();
  mesh->SetArrays(std::move(arrays));
  return mesh;
}

py::object
ArrayOwner(const itk::DataObject * object)
{
  if (object->GetSource())
  {
    return py::none();
  }
  object->Register();
  return py::capsule(object, [](void * pointer) { static_cast<const itk::DataObject *>(pointer)->UnRegister(); });
}

std::vector<Vector3>
ToPoints(const Array<double> & array, const char * name)
{
  if (array.ndim() != 2 || array.shape(1) != 3)
  {
    throw UsageFailure(std::string(name) + " must be an array of n x 3 numbers");
  }
  const auto * first = reinterpret_cast<const Vector3 *>(array.data());
  return { first, first + array.shape(0) };
}

std::vector<std::array<IdType, 3>>
ToTriangles(const Array<IdType> & array)
{
  if (array.ndim() != 2 || array.shape(1) != 3)
  {
    throw UsageFailure("triangles must be an array of t x 3 ids of points");
  }
  const auto * first = reinterpret_cast<const std::array<IdType, 3> *>(array.data());
  return { first, first + array.shape(0) };
}

py::array_t<double>
FromPoints(const std::vector<Vector3> & points)
{
  static_assert(sizeof(Vector3) == 3 * sizeof(double), "points are numbers one beside the other");
  return py::array_t<double>({ static_cast<py::ssize_t>(points.size()), py::ssize_t{ 3 } },
                             points.empty() ? nullptr : points.front().data());
}

Vector3
ToVector(const py::object & object, const char * name)
{
  const auto array = Array<double>::ensure(object);
  if (!array || array.ndim() != 1 || array.size() != 3)
  {
    PyErr_Clear();
    throw UsageFailure(std::string(name) + " must be three numbers");
  }
  return { array.at(0), array.at(1), array.at(2) };
}

std::string
SnakeCase(const std::string & name)
{
  std::string snake;
  for (const char c : name)
  {
    if (std::isupper(static_cast<unsigned char>(c)) != 0 && !snake.empty())
    {
      snake += '_';
    }
    snake += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return snake;
}
} // namespace bone::python
