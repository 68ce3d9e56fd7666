/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef filters_h
#define filters_h

#include "objects.h"
#include "parameter_table.h"

#include <itkProcessObject.h>

#include <functional>

namespace bone::python
{
/** \defgroup FilterBindings Process objects as classes of Python
 * Inputs and outputs are properties, and so is each parameter of a filter's table.
 * \{ */
template <typename TFilter>
using FilterClass = py::class_<TFilter, itk::SmartPointer<TFilter>, itk::ProcessObject>;

/** A filter of Python: it listens to Ctrl-C, and never writes where an array may still look. */
void
PrepareFilter(itk::ProcessObject * filter);
/** Runs what is out of date, without the GIL. `progress` is called with 0 to 1 unless it is None. */
void
UpdateFilter(itk::ProcessObject & filter, const py::object & progress);
/** The same of anything that runs the filter. */
void
RunFilter(itk::ProcessObject & filter, const py::object & progress, const std::function<void()> & run);
/** Keeps the filter that makes an input alive as long as `filter`; ITK does not. */
void
HoldSource(itk::ProcessObject & filter, const std::string & input, const itk::DataObject * data);
/** An output, which keeps its filter alive. */
py::object
OutputOf(const py::object & filter, itk::DataObject * output);
/** An image's most derived class is not known to Python. */
inline py::object
CastData(itk::DataObject * data)
{
  if (auto * image = dynamic_cast<ImageBase *>(data))
  {
    return py::cast(itk::SmartPointer<ImageBase>(image));
  }
  return py::cast(itk::SmartPointer<itk::DataObject>(data));
}

/** Keeps how type stubs declare a property: "degree: int". */
template <typename TFilter>
void
AddMember(FilterClass<TFilter> & filter, const char * name, const std::string & annotation, bool readOnly = false)
{
  filter.attr("_members")[name] = readOnly ? "-> " + annotation : annotation;
}
/** The name of a data object's class in Python. */
template <typename TData>
std::string
NameOfClass()
{
  if constexpr (std::is_base_of_v<ImageBase, TData>)
  {
    return "Image";
  }
  else
  {
    return py::type::of<TData>().attr("__name__").template cast<std::string>();
  }
}

template <typename TFilter>
FilterClass<TFilter>
AddFilter(py::module_ & m, const char * name, const char * doc)
{
  FilterClass<TFilter> filter(m, name, doc);
  filter.def(py::init([] {
    typename TFilter::Pointer made = TFilter::New();
    PrepareFilter(made);
    return made;
  }));
  filter.attr("parameter_names") = py::tuple();
  filter.attr("_members") = py::dict();
  return filter;
}

/** Adds a property for each parameter. `get` gives the struct of a filter, `set` takes one. */
template <typename TStruct, typename TFilter, typename TGet, typename TSet>
void
AddParameters(FilterClass<TFilter> & filter, TGet get, TSet set)
{
  const auto entries = ListParameters<TStruct>();
  py::list   names(filter.attr("parameter_names"));
  for (std::size_t i = 0; i < entries.size(); ++i)
  {
    filter.def_property(
      entries[i].name.c_str(),
      [i, get](const TFilter & self) { return GetParameter<TStruct>(get(self), i); },
      [i, get, set](TFilter & self, const py::object & value) {
        TStruct parameters = get(self);
        SetParameter(parameters, i, value);
        set(self, parameters);
      },
      entries[i].help.c_str());
    names.append(entries[i].name);
    AddMember(filter, entries[i].name.c_str(), entries[i].annotation);
  }
  filter.attr("parameter_names") = py::tuple(names);
}

/** The parameters that TFilter::GetParameters gives. */
template <typename TFilter>
void
AddParameters(FilterClass<TFilter> & filter)
{
  using Struct = std::decay_t<decltype(std::declval<const TFilter &>().GetParameters())>;
  AddParameters<Struct>(
    filter,
    [](const TFilter & self) -> const Struct & { return self.GetParameters(); },
    [](TFilter & self, const Struct & parameters) { self.SetParameters(parameters); });
}

/** An input that is not an image. `get` and `set` as the filter's. */
template <typename TData, typename TFilter, typename TGet, typename TSet>
void
AddInput(FilterClass<TFilter> & filter, const char * name, TGet get, TSet set, const char * doc)
{
  filter.def_property(
    name,
    [get](TFilter & self) { return itk::SmartPointer<TData>(const_cast<TData *>(get(self))); },
    [set, input = std::string(name)](TFilter & self, TData * data) {
      HoldSource(self, input, data);
      set(self, data);
    },
    doc);
  AddMember(filter, name, "Optional[" + NameOfClass<TData>() + ']');
}

/** A CT or radiograph: float. */
template <typename TFilter, typename TGet, typename TSet>
void
AddImageInput(FilterClass<TFilter> & filter, const char * name, TGet get, TSet set, const char * doc)
{
  filter.def_property(
    name,
    [get](TFilter & self) { return itk::SmartPointer<ImageBase>(const_cast<CTImage *>(get(self))); },
    [set, input = std::string(name)](TFilter & self, const py::object & object) {
      const CTImage::Pointer image = object.is_none() ? nullptr : ToCT(ToImage(object));
      HoldSource(self, input, image);
      set(self, image.GetPointer());
    },
    doc);
  AddMember(filter, name, "_ImageInput");
}

/** A label map: whole numbers. */
template <typename TFilter, typename TGet, typename TSet>
void
AddLabelInput(FilterClass<TFilter> & filter, const char * name, TGet get, TSet set, const char * doc)
{
  filter.def_property(
    name,
    [get](TFilter & self) { return itk::SmartPointer<ImageBase>(const_cast<LabelImage *>(get(self))); },
    [set, input = std::string(name)](TFilter & self, const py::object & object) {
      const LabelImage::Pointer labels = object.is_none() ? nullptr : ToLabels(ToImage(object));
      HoldSource(self, input, labels);
      set(self, labels.GetPointer());
    },
    doc);
  AddMember(filter, name, "_ImageInput");
}

template <typename TFilter, typename TGet>
void
AddOutput(FilterClass<TFilter> & filter, const char * name, TGet get, const char * doc)
{
  filter.def_property_readonly(
    name, [get](const py::object & self) { return OutputOf(self, get(self.cast<TFilter &>())); }, doc);
  using Data = std::remove_cv_t<std::remove_pointer_t<decltype(get(std::declval<TFilter &>()))>>;
  AddMember(filter, name, NameOfClass<Data>(), true);
}
/** \} */

void
BindContourFilters(py::module_ & m);
void
BindMeshFilters(py::module_ & m);
void
BindDensityFilters(py::module_ & m);
void
BindRadiographFilters(py::module_ & m);
void
BindRegistrationFilters(py::module_ & m);
void
BindAtlasFilters(py::module_ & m);
void
BindRadiographOperators(py::module_ & m);
void
BindBuild(py::module_ & m);
} // namespace bone::python

/** Arguments `get, set` of AddInput for an input with Get<name> and Set<name>. */
#define BONE_PYTHON_INPUT(Filter, name)                                                                                \
  [](const Filter & self) { return self.Get##name(); }, [](Filter & self, auto * data) { self.Set##name(data); }

#endif
