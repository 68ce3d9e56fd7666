/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "parameter_table.h"

namespace bone::python
{
namespace
{
[[noreturn]] void
RefuseType(const ParameterField & field, const char * wanted, const py::handle & object)
{
  PyErr_Clear();
  throw UsageFailure(std::string(field.name) + " must be " + wanted + ", not " + py::repr(object).cast<std::string>() +
                     '.');
}
} // namespace

double
ToReal(const py::handle & object, const ParameterField & field)
{
  const double value = PyFloat_AsDouble(object.ptr());
  if (PyErr_Occurred() != nullptr)
  {
    RefuseType(field, "a number", object);
  }
  return value;
}

std::int64_t
ToWhole(const py::handle & object, const ParameterField & field, std::int64_t lower, std::int64_t upper)
{
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(object.ptr()));
  if (!whole || PyBool_Check(object.ptr()))
  {
    RefuseType(field, "a whole number", object);
  }
  const std::int64_t value = PyLong_AsLongLong(whole.ptr());
  if (PyErr_Occurred() != nullptr || value < lower || value > upper)
  {
    RefuseType(
      field, ("a whole number from " + std::to_string(lower) + " to " + std::to_string(upper)).c_str(), object);
  }
  return value;
}

std::uint64_t
ToWhole(const py::handle & object, const ParameterField & field)
{
  const auto          whole = py::reinterpret_steal<py::object>(PyNumber_Index(object.ptr()));
  const std::uint64_t value = whole ? PyLong_AsUnsignedLongLong(whole.ptr()) : 0;
  if (!whole || PyErr_Occurred() != nullptr || PyBool_Check(object.ptr()))
  {
    RefuseType(field, "a whole number, 0 or more", object);
  }
  return value;
}

bool
ToFlag(const py::handle & object, const ParameterField & field)
{
  const bool numpy = std::string(Py_TYPE(object.ptr())->tp_name).rfind("numpy.bool", 0) == 0;
  if (!PyBool_Check(object.ptr()) && !numpy)
  {
    RefuseType(field, "True or False", object);
  }
  return PyObject_IsTrue(object.ptr()) == 1;
}

std::string
ToName(const py::handle & object, const ParameterField & field)
{
  if (!py::isinstance<py::str>(object))
  {
    RefuseType(field, "a name", object);
  }
  return object.cast<std::string>();
}

std::string
DescribeParameter(const ParameterField & field, const std::string & initial, const std::string & choices, bool number)
{
  std::string text = field.help;
  if (!choices.empty())
  {
    text += ": " + choices;
  }
  text += ". ";
  if (*field.unit != '\0')
  {
    text += "Unit: " + std::string(field.unit) + ". ";
  }
  const std::string range = number ? field.range.Describe() : std::string();
  if (!range.empty())
  {
    text += "Range: " + range + ". ";
  }
  return text + "Default: " + (initial.empty() ? "none" : initial) + '.';
}
} // namespace bone::python
