/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTestMeasures_h
#define boneTestMeasures_h

#include "boneMeasure.h"

#include <gtest/gtest.h>

#include <string>

namespace bone
{
/** The first number of a measure; a failure where there is none of the name. */
inline double
ValueOf(const MeasureList & list, const std::string & name)
{
  for (const Measure & measure : list.measures)
  {
    if (measure.name == name)
    {
      return measure.value.at(0);
    }
  }
  ADD_FAILURE() << name << " is missing";
  return 0.0;
}

/** The side of the body that was found; empty where none was. */
inline std::string
SideOf(const MeasureList & list)
{
  for (const Measure & measure : list.measures)
  {
    if (measure.name == "side")
    {
      return measure.text;
    }
  }
  return "";
}
} // namespace bone

#endif
