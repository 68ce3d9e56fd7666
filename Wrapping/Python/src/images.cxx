/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bindings.h"
#include "failure.h"
#include "objects.h"

namespace bone::python
{
namespace
{
/** A pixel container over an array of Python, which it keeps alive. */
template <typename TPixel>
class ArrayContainer : public itk::ImportImageContainer<itk::SizeValueType, TPixel>
{
public:
  using Self = ArrayContainer;
  using Superclass = itk::ImportImageContainer<itk::SizeValueType, TPixel>;
  using Pointer = itk::SmartPointer<Self>;
  itkFactorylessNewMacro(Self);

  /** `owner`: what else the memory needs. */
  void
  SetArray(const py::array & array, const py::object & owner)
  {
    this->SetImportPointer(
      static_cast<TPixel *>(const_cast<void *>(array.data())), static_cast<itk::SizeValueType>(array.size()), false);
    m_Array = py::make_tuple(array, owner).release().ptr();
    m_Writable = array.writeable();
  }
  bool
  IsWritable() const
  {
    return m_Writable;
  }

protected:
  ~ArrayContainer() override
  {
    if (m_Array != nullptr && Py_IsInitialized() != 0)
    {
      const py::gil_scoped_acquire acquire;
      Py_DECREF(m_Array);
    }
  }

private:
  PyObject * m_Array{ nullptr };
  bool       m_Writable{ true };
};

/** An array of float32 or int16, C-contiguous: the array itself where it is one, else a copy. */
py::array
ToPixels(const py::object & object)
{
  const py::module_ numpy = py::module_::import("numpy");
  py::array         array = numpy.attr("asarray")(object);
  if (array.ndim() != 3 || array.size() == 0)
  {
    throw UsageFailure("an image's array must have three axes [z, y, x], each of one voxel at least; it has shape " +
                       py::str(array.attr("shape")).cast<std::string>());
  }
  const char kind = array.dtype().kind();
  if (kind == 'b' || kind == 'i' || kind == 'u')
  {
    const auto fits = [&array](const char * which, long bound) {
      const auto value = array.attr(which)().cast<long>();
      return bound < 0 ? value >= bound : value <= bound;
    };
    const bool small = kind == 'b' || array.itemsize() == 1 || (kind == 'i' && array.itemsize() == 2);
    if (!small && !(fits("min", -32768) && fits("max", 32767)))
    {
      throw UsageFailure("an image of whole numbers must lie within -32768 to 32767; convert it to float32 for others");
    }
    return py::array_t<short, py::array::c_style | py::array::forcecast>(array);
  }
  if (kind != 'f')
  {
    throw UsageFailure("an image holds numbers, not " + py::str(array.dtype()).cast<std::string>());
  }
  return py::array_t<float, py::array::c_style | py::array::forcecast>(array);
}

template <typename TPixel>
itk::SmartPointer<ImageBase>
Import(const py::array & array, const py::object & owner)
{
  using ImageType = itk::Image<TPixel, 3>;
  auto                         image = ImageType::New();
  typename ImageType::SizeType size;
  for (unsigned int k = 0; k < 3; ++k)
  {
    size[k] = static_cast<itk::SizeValueType>(array.shape(2 - static_cast<int>(k)));
  }
  auto container = ArrayContainer<TPixel>::New();
  container->SetArray(array, owner);
  image->SetRegions(size);
  image->SetPixelContainer(container);
  return image.GetPointer();
}

void
SetPlace(ImageBase * image, const py::object & origin, const py::object & spacing, const py::object & direction)
{
  const Vector3 o = ToVector(origin, "origin");
  const Vector3 s = ToVector(spacing, "spacing");
  if (!o.allFinite() || !s.allFinite() || !(s.minCoeff() > 0))
  {
    throw UsageFailure("an image's spacing must be above 0 mm and its origin finite");
  }
  image->SetOrigin(o.data());
  image->SetSpacing(s.data());
  if (direction.is_none())
  {
    return;
  }
  const auto d = Array<double>::ensure(direction);
  if (!d || d.size() != 9)
  {
    PyErr_Clear();
    throw UsageFailure("direction must be 3 x 3 numbers, whose columns are the axes of x, y and z");
  }
  ImageBase::DirectionType matrix;
  std::copy(d.data(), d.data() + 9, matrix.GetVnlMatrix().data_block());
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(d.data());
  if (!((axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-4))
  {
    throw UsageFailure("direction must be orthonormal: an image's axes are unit vectors at right angles");
  }
  image->SetDirection(matrix);
}

template <typename TPixel>
py::object
ViewPixels(const itk::Image<TPixel, 3> * image)
{
  const auto * container = image->GetPixelContainer();
  if (image->GetBufferPointer() == nullptr)
  {
    throw UsageFailure("this image holds no voxels yet: call update() of the filter that makes it");
  }
  container->Register();
  const py::capsule   owner(container,
                          [](void * pointer) { static_cast<const itk::LightObject *>(pointer)->UnRegister(); });
  const auto          size = image->GetBufferedRegion().GetSize();
  py::array_t<TPixel> array({ size[2], size[1], size[0] }, image->GetBufferPointer(), owner);
  const auto *        mine = dynamic_cast<const ArrayContainer<TPixel> *>(container);
  if (mine != nullptr && !mine->IsWritable())
  {
    array.attr("flags").attr("writeable") = false;
  }
  return std::move(array);
}

py::object
ViewImage(const ImageBase & image)
{
  if (const auto * ct = dynamic_cast<const CTImage *>(&image))
  {
    return ViewPixels(ct);
  }
  return ViewPixels(dynamic_cast<const LabelImage *>(&image));
}

Vector3
OriginOf(const ImageBase & image)
{
  ImageBase::PointType point;
  image.TransformIndexToPhysicalPoint(image.GetBufferedRegion().GetIndex(), point);
  return { point[0], point[1], point[2] };
}

py::tuple
SpacingOf(const ImageBase & image)
{
  return FromVector(Vector3(image.GetSpacing().GetDataPointer()));
}

py::array_t<double>
DirectionOf(const ImageBase & image)
{
  return py::array_t<double>({ 3, 3 }, image.GetDirection().GetVnlMatrix().data_block());
}

itk::SmartPointer<ImageBase>
MakeImage(const py::object & array,
          const py::object & origin,
          const py::object & spacing,
          const py::object & direction,
          const py::object & owner = py::none())
{
  const py::array pixels = ToPixels(array);
  auto            image = pixels.dtype().kind() == 'f' ? Import<float>(pixels, owner) : Import<short>(pixels, owner);
  SetPlace(image, origin, spacing, direction);
  return image;
}

py::tuple
ImageState(const ImageBase & image)
{
  return py::make_tuple(
    ViewImage(image).attr("copy")(), FromVector(OriginOf(image)), SpacingOf(image), DirectionOf(image));
}

std::string
DescribeImage(const ImageBase & image)
{
  const auto         size = image.GetLargestPossibleRegion().GetSize();
  std::ostringstream text;
  text << "<bonetk.Image " << size[2] << " x " << size[1] << " x " << size[0] << ' '
       << (dynamic_cast<const CTImage *>(&image) != nullptr ? "float32" : "int16") << ", spacing " << image.GetSpacing()
       << " mm>";
  return text.str();
}

itk::SmartPointer<ImageBase>
ReadImage(const std::string & path, const std::string & series)
{
  const py::gil_scoped_release release;
  return ReadCT(path, series).GetPointer();
}

itk::SmartPointer<ImageBase>
ReadLabelMap(const std::string & path)
{
  const py::gil_scoped_release release;
  return ReadLabels(path).GetPointer();
}

void
WriteAny(const py::object & object, const std::string & path)
{
  const auto                   image = ToImage(object);
  const py::gil_scoped_release release;
  if (const auto * labels = dynamic_cast<const LabelImage *>(image.GetPointer()))
  {
    WriteImage(labels, path);
    return;
  }
  WriteImage(ToCT(image).GetPointer(), path);
}

/** Errors of this module's own. */
void
TranslateFailures(std::exception_ptr pointer)
{
  const auto raise = [](const char * name, const std::exception & error) {
    PyErr_SetString(py::module_::import("bonetk._bonetk").attr(name).ptr(), error.what());
  };
  try
  {
    std::rethrow_exception(pointer);
  }
  catch (const UsageFailure & error)
  {
    raise("UsageError", error);
  }
  catch (const DataFailure & error)
  {
    raise("DataError", error);
  }
  catch (const std::invalid_argument & error)
  {
    raise("UsageError", error);
  }
}
} // namespace
} // namespace bone::python

void
BindImages(pybind11::module_ & m)
{
  using namespace bone::python;
  py::register_exception_translator(&TranslateFailures);
  py::class_<itk::DataObject, itk::SmartPointer<itk::DataObject>>(
    m, "DataObject", "Base of what filters take and make.")
    .def(
      "modified", &itk::DataObject::Modified, "Marks the object as changed, so that filters that took it run again.");

  py::class_<ImageBase, itk::SmartPointer<ImageBase>, itk::DataObject>(
    m,
    "Image",
    "A three-dimensional image in physical space: LPS, mm.\n\n"
    "array: [z, y, x]. A C-contiguous array of float32 (CT, radiographs) or int16 (label maps) is taken as it is, "
    "without a copy; the image keeps it alive. Whole numbers of other types become int16, other reals float32, by a "
    "copy.\norigin: (x, y, z) of the centre of voxel array[0, 0, 0], mm.\nspacing: (x, y, z), mm.\n"
    "direction: 3 x 3, its columns the axes of x, y and z; None: identity.\n"
    "owner: an object to keep alive too, where the array does not.\n"
    "After values were changed in place call modified(), so that filters run again.")
    .def(py::init(&MakeImage),
         py::arg("array"),
         py::arg("origin") = py::make_tuple(0.0, 0.0, 0.0),
         py::arg("spacing") = py::make_tuple(1.0, 1.0, 1.0),
         py::arg("direction") = py::none(),
         py::kw_only(),
         py::arg("owner") = py::none())
    .def_property_readonly("array", &ViewImage, "The voxels [z, y, x]: a view of the image's own memory.")
    .def(
      "__array__",
      [](const ImageBase & image, const py::object & type) {
        py::object array = ViewImage(image);
        return type.is_none() ? array : py::object(array.attr("astype")(type, py::arg("copy") = false));
      },
      py::arg("dtype") = py::none())
    .def_property_readonly(
      "origin",
      [](const ImageBase & image) { return FromVector(OriginOf(image)); },
      "(x, y, z) of the centre of voxel array[0, 0, 0], mm.")
    .def_property_readonly(
      "spacing", [](const ImageBase & image) { return SpacingOf(image); }, "(x, y, z), mm.")
    .def_property_readonly("direction", &DirectionOf, "3 x 3; column k is the axis of index k.")
    .def_property_readonly(
      "shape",
      [](const ImageBase & image) {
        const auto size = image.GetLargestPossibleRegion().GetSize();
        return py::make_tuple(size[2], size[1], size[0]);
      },
      "Voxels along z, y and x.")
    .def("__repr__", &DescribeImage)
    .def("__copy__", [](const py::object & image) { return image.attr("__deepcopy__")(py::none()); })
    .def("__deepcopy__",
         [](const ImageBase & image, const py::object &) {
           const py::tuple state = ImageState(image);
           return MakeImage(state[0], state[1], state[2], state[3]);
         })
    .def(py::pickle(&ImageState,
                    [](const py::tuple & state) { return MakeImage(state[0], state[1], state[2], state[3]); }));

  m.def("_read_ct", &ReadImage, py::arg("path"), py::arg("series") = "");
  m.def("_read_labels", &ReadLabelMap, py::arg("path"));
  m.def("write_image",
        &WriteAny,
        py::arg("image"),
        py::arg("path"),
        "Writes an image, the whole file or none; the format is that of the name's extension (.nii.gz, .mha, .nrrd).");
}
