/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef objects_h
#define objects_h

#include "boneDensityMesh.h"
#include "boneImageIO.h"

#include <itkDataObject.h>
#include <itkProcessObject.h>
#include <itkSmartPointer.h>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <string>
#include <vector>

PYBIND11_DECLARE_HOLDER_TYPE(T, itk::SmartPointer<T>, true)
namespace pybind11::detail
{
template <typename T>
struct holder_helper<itk::SmartPointer<T>>
{
  static T *
  get(const itk::SmartPointer<T> & pointer)
  {
    return pointer.GetPointer();
  }
};
} // namespace pybind11::detail

namespace bone::python
{
namespace py = pybind11;

using Mesh = DensityMesh<double>;
using ImageBase = itk::ImageBase<3>;
template <typename T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

/** \defgroup Objects Objects and arrays between C++ and Python
 * \{ */

/** An image of Python: an Image, or what bonetk.as_image takes. */
itk::SmartPointer<ImageBase>
ToImage(const py::object & object);
/** As float; a copy where the image has other pixels. */
CTImage::Pointer
ToCT(const ImageBase * image);
/** As whole numbers. Throws UsageFailure where the image has others. */
LabelImage::Pointer
ToLabels(const ImageBase * image);

/** A copy as Python's mesh, which stands alone. */
Mesh::Pointer
MakeMesh(MeshArrays arrays);
/** What keeps the arrays of an object alive that no filter will change: itself. None for an output of a filter, whose
 * arrays are to be copied. */
py::object
ArrayOwner(const itk::DataObject * object);

/** The memory of `data` as an array that cannot be written; a copy where the owner is None. */
template <typename T>
py::object
View(const T * data, std::vector<py::ssize_t> shape, const py::object & owner)
{
  if (owner.is_none())
  {
    return py::array_t<T>(std::move(shape), data);
  }
  py::array_t<T> array(std::move(shape), data, owner);
  array.attr("flags").attr("writeable") = false;
  return std::move(array);
}

/** A copy. */
template <typename T>
py::array_t<T>
Copy(const std::vector<T> & values)
{
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

/** n x 3 numbers as points, and back as a copy. Throws UsageFailure for another shape. */
std::vector<Vector3>
ToPoints(const Array<double> & array, const char * name);
/** t x 3 ids of points. Throws UsageFailure for another shape. */
std::vector<std::array<IdType, 3>>
ToTriangles(const Array<IdType> & array);
py::array_t<double>
FromPoints(const std::vector<Vector3> & points);
Vector3
ToVector(const py::object & object, const char * name);
inline py::tuple
FromVector(const Vector3 & v)
{
  return py::make_tuple(v.x(), v.y(), v.z());
}

/** "huToAttenuation" as "hu_to_attenuation". */
std::string
SnakeCase(const std::string & name);
/** \} */
} // namespace bone::python

#endif
