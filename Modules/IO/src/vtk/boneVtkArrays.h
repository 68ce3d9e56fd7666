/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVtkArrays_h
#define boneVtkArrays_h

#include "boneRefuse.h"

#include <vtkAbstractArray.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkSmartPointer.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace bone
{
/** The numeric array of that name with that many tuples and components (0: any), or null where there is none. Throws
 * itk::ExceptionObject where there is one that differs. */
inline vtkDataArray *
FindArray(vtkFieldData * data, const char * name, vtkIdType tuples, int components)
{
  vtkAbstractArray * any = data->GetAbstractArray(name);
  if (any == nullptr)
  {
    return nullptr;
  }
  auto * array = vtkDataArray::SafeDownCast(any);
  if (array == nullptr)
  {
    Refuse("the array '", name, "' is not numeric");
  }
  if (array->GetNumberOfTuples() != tuples)
  {
    Refuse("the array '", name, "' has ", array->GetNumberOfTuples(), " entries where ", tuples, " are needed");
  }
  if (components != 0 && array->GetNumberOfComponents() != components)
  {
    Refuse(
      "the array '", name, "' has ", array->GetNumberOfComponents(), " components where ", components, " are needed");
  }
  return array;
}

/** A component as a whole number within [lowest, highest]; throws itk::ExceptionObject where it is none. */
inline long long
WholeNumber(vtkDataArray * array, vtkIdType tuple, int component, long long lowest, long long highest)
{
  const double value = array->GetComponent(tuple, component);
  if (!(value >= static_cast<double>(lowest) && value <= static_cast<double>(highest)) || value != std::floor(value))
  {
    Refuse("the array '",
           array->GetName(),
           "' has the value ",
           value,
           " at entry ",
           tuple,
           " where a whole number from ",
           lowest,
           " to ",
           highest,
           " is needed");
  }
  return static_cast<long long>(value);
}

/** All entries of a one-component array as int. */
inline std::vector<int>
WholeNumbers(vtkDataArray * array, long long lowest, long long highest)
{
  std::vector<int> values(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = static_cast<int>(WholeNumber(array, static_cast<vtkIdType>(i), 0, lowest, highest));
  }
  return values;
}

/** A named VTK array with a value for each tuple and component from value(tuple, component). */
template <typename TArray, typename TValue>
vtkSmartPointer<TArray>
MakeArray(const char * name, vtkIdType tuples, int components, TValue && value)
{
  auto array = vtkSmartPointer<TArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  for (vtkIdType i = 0; i < tuples; ++i)
  {
    for (int k = 0; k < components; ++k)
    {
      array->SetTypedComponent(i, k, static_cast<typename TArray::ValueType>(value(i, k)));
    }
  }
  return array;
}
} // namespace bone

#endif
