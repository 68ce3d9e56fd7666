/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bindings.h"

#include "boneIOError.h"
#include "boneSession.h"

#include <itkMultiThreaderBase.h>

#include <new>

namespace py = pybind11;

namespace
{
/** Turns exceptions of C++ into those of Python: one line, without addresses and places in the source. */
void
Translate(std::exception_ptr pointer)
{
  const py::module_ module = py::module_::import("bonetk._bonetk");
  try
  {
    std::rethrow_exception(pointer);
  }
  catch (const bone::UsageError & error)
  {
    PyErr_SetString(module.attr("UsageError").ptr(), error.what());
  }
  catch (const itk::MemoryAllocationError &)
  {
    PyErr_SetString(PyExc_MemoryError, "not enough memory for this input");
  }
  catch (const bone::MachineError & error)
  {
    PyErr_SetString(module.attr("Error").ptr(), error.what());
  }
  catch (const itk::ExceptionObject & error)
  {
    PyErr_SetString(module.attr("DataError").ptr(), bone::ErrorLine(error).c_str());
  }
}

/** Exceptions stay alive as long as the module. */
void
AddExceptions(py::module_ & m)
{
  const auto add = [&m](const char * name, const char * doc, const py::object & base) {
    const auto error = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc((std::string("bonetk.") + name).c_str(), doc, base.ptr(), nullptr));
    m.attr(name) = error;
    return error;
  };
  const py::object error = add("Error",
                               "An error of BoneTK: one line that says which input, what is wrong and what to do. "
                               "Itself where the disk is full; the program bonetk ends with 3.",
                               py::reinterpret_borrow<py::object>(PyExc_RuntimeError));
  add("DataError", "Data are not what the work needs; the program bonetk ends with 1.", error);
  add("UsageError", "A call that cannot be meant; the program bonetk ends with 2.", error);
}

void
SetThreads(int threads)
{
  constexpr int most = 1024;
  if (threads < 0 || threads > most)
  {
    throw py::value_error("threads must be 0, for all processors, or a number from 1 to 1024; got " +
                          std::to_string(threads));
  }
  static const itk::ThreadIdType all = itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads();
  const auto                     number = threads == 0 ? all : static_cast<itk::ThreadIdType>(threads);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(number);
}
} // namespace

PYBIND11_MODULE(_bonetk, m)
{
  m.doc() = "What of BoneTK is C++; import bonetk.";
  AddExceptions(m);
  py::register_exception_translator(&Translate);
  m.attr("version") = BONETK_VERSION;
  m.def("set_threads",
        &SetThreads,
        py::arg("threads"),
        "Number of threads of all that follows; 0: all processors. Results do not depend on it.");
  m.def("get_threads", &itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads, "Number of threads, see set_threads.");
  BindCommands(m);
  BindImages(m);
  BindMesh(m);
  BindModels(m);
  BindRadiograph(m);
  BindFilters(m);
}
