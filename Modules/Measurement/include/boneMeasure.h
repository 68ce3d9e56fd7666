/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeasure_h
#define boneMeasure_h

#include <string>
#include <vector>

namespace bone
{
/** A measure of a bone. */
struct Measure
{
  std::string         name;       ///< "neckShaftAngle"
  std::vector<double> value;      ///< one number; a point has three, a profile more
  std::string         unit;       ///< "mm", "degree", "mm^3", ...; empty: none
  std::string         definition; ///< what it is, with its source
  std::string         text{};     ///< in place of numbers, where it is a word
  double              error{ 0 }; ///< bound of the value's error, in its unit; 0: up to rounding
};

/** A measure that could not be taken. */
struct MissingMeasure
{
  std::string name;
  std::string reason; ///< what is missing, and what to do
};

/** What was measured, and what could not be. */
struct MeasureList
{
  std::vector<Measure>        measures;
  std::vector<MissingMeasure> missing;

  void
  Append(const MeasureList & other)
  {
    measures.insert(measures.end(), other.measures.begin(), other.measures.end());
    missing.insert(missing.end(), other.missing.begin(), other.missing.end());
  }
};
} // namespace bone

#endif
