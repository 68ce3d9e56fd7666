/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "filters.h"

#include "analysis.h"
#include "bindings.h"

#include <itkCommand.h>
#include <itkMetaDataObject.h>

#include <unordered_map>

namespace bone::python
{
namespace
{
/** What stopped a filter and waits to be raised; with the GIL only. */
std::unordered_map<const itk::ProcessObject *, py::error_already_set> &
PendingErrors()
{
  static auto * errors = new std::unordered_map<const itk::ProcessObject *, py::error_already_set>();
  return *errors;
}

/** Stops the filter where Python has something to raise. With the GIL. */
void
StopOnError(itk::ProcessObject * filter)
{
  if (PyErr_Occurred() != nullptr)
  {
    PendingErrors().emplace(filter, py::error_already_set());
    filter->SetAbortGenerateData(true);
  }
}

void
ListenForInterrupt(itk::Object * caller, const itk::EventObject &, void *)
{
  const py::gil_scoped_acquire acquire;
  auto * const                 filter = static_cast<itk::ProcessObject *>(caller);
  if (PendingErrors().count(filter) == 0 && PyErr_CheckSignals() != 0)
  {
    StopOnError(filter);
  }
}

/** Raises what stopped the filter or one before it. */
void
RaisePending(const itk::ProcessObject * filter)
{
  const auto found = PendingErrors().find(filter);
  if (found != PendingErrors().end())
  {
    py::error_already_set error = std::move(found->second);
    PendingErrors().erase(found);
    throw error;
  }
  for (const auto & input : const_cast<itk::ProcessObject *>(filter)->GetInputs())
  {
    if (input && input->GetSource())
    {
      RaisePending(input->GetSource());
    }
  }
}

/** Calls a function of Python at each step of the filter's progress. */
class ProgressListener
{
public:
  ProgressListener(itk::ProcessObject & filter, const py::object & function)
    : m_Filter(filter)
    , m_Function(function)
  {
    if (!m_Function.is_none())
    {
      m_Tag = m_Filter.AddObserver(itk::ProgressEvent(), [this](const itk::EventObject &) { this->Tell(); });
    }
  }
  ProgressListener(const ProgressListener &) = delete;
  ProgressListener &
  operator=(const ProgressListener &) = delete;
  ~ProgressListener()
  {
    if (!m_Function.is_none())
    {
      m_Filter.RemoveObserver(m_Tag);
    }
  }

private:
  void
  Tell()
  {
    const py::gil_scoped_acquire acquire;
    if (PendingErrors().count(&m_Filter) == 0)
    {
      Py_XDECREF(PyObject_CallFunction(m_Function.ptr(), "d", static_cast<double>(m_Filter.GetProgress())));
      StopOnError(&m_Filter);
    }
  }

  itk::ProcessObject & m_Filter;
  py::object           m_Function;
  unsigned long        m_Tag{ 0 };
};
} // namespace

void
PrepareFilter(itk::ProcessObject * filter)
{
  // Each run makes new memory, so that arrays of the last run stay what they were.
  filter->ReleaseDataBeforeUpdateFlagOn();
  auto command = itk::CStyleCommand::New();
  command->SetCallback(&ListenForInterrupt);
  filter->AddObserver(itk::ProgressEvent(), command);
}

void
RunFilter(itk::ProcessObject & filter, const py::object & progress, const std::function<void()> & run)
{
  const itk::ProcessObject::Pointer keep(&filter);
  const ProgressListener            listener(filter, progress);
  try
  {
    const py::gil_scoped_release release;
    run();
  }
  catch (...)
  {
    RaisePending(&filter);
    throw;
  }
  RaisePending(&filter);
}

void
UpdateFilter(itk::ProcessObject & filter, const py::object & progress)
{
  RunFilter(filter, progress, [&filter] { filter.Update(); });
}

void
HoldSource(itk::ProcessObject & filter, const std::string & input, const itk::DataObject * data)
{
  itk::ProcessObject::Pointer source;
  if (data != nullptr && data->GetSource())
  {
    source = data->GetSource().GetPointer();
  }
  itk::EncapsulateMetaData<itk::ProcessObject::Pointer>(filter.GetMetaDataDictionary(), "source of " + input, source);
}

py::object
OutputOf(const py::object & filter, itk::DataObject * output)
{
  py::object object = CastData(output);
  // One that Python had before keeps its filter already.
  if (!object.is_none() && Py_REFCNT(object.ptr()) == 1)
  {
    py::detail::keep_alive_impl(object, filter);
  }
  return object;
}
} // namespace bone::python

void
BindFilters(pybind11::module_ & m)
{
  using namespace bone::python;
  py::class_<itk::ProcessObject, itk::SmartPointer<itk::ProcessObject>> process(
    m, "ProcessObject", "Base of the filters: set inputs and parameters, call update(), take the output.");
  process.attr("parameter_names") = py::tuple();
  process
    .def("update",
         &UpdateFilter,
         py::arg("progress") = py::none(),
         "Runs this filter and those before it, where an input or a parameter has changed, and no others.\n\n"
         "progress: a function that is called with this filter's progress, 0 to 1; what it raises stops the work.")
    .def("modified", &itk::ProcessObject::Modified, "Marks the filter as changed, so that it runs again.")
    .def_property_readonly("modified_time", &itk::ProcessObject::GetMTime)
    .def("__repr__", [](const py::object & self) {
      std::string text = "<bonetk." + self.attr("__class__").attr("__name__").cast<std::string>();
      for (const auto & name : self.attr("parameter_names"))
      {
        text += ' ' + name.cast<std::string>() + '=' +
                py::repr(self.attr(py::reinterpret_borrow<py::object>(name))).cast<std::string>();
      }
      return text + '>';
    });
  m.def(
    "_detach",
    [](const py::object & object) {
      object.cast<itk::DataObject *>()->DisconnectPipeline();
      // It needs its filter no more (see OutputOf).
      if (reinterpret_cast<py::detail::instance *>(object.ptr())->has_patients)
      {
        py::detail::clear_patients(object.ptr());
      }
      return object;
    },
    "Makes an output stand alone.");
  BindContourFilters(m);
  BindMeshFilters(m);
  BindDensityFilters(m);
  BindRadiographFilters(m);
  BindRadiographOperators(m);
  BindAtlasFilters(m);
  BindRegistrationFilters(m);
  BindBuild(m);
  BindAnalysis(m);
  BindFiniteElements(m);
}
