/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTicks_h
#define boneTicks_h

#include <string>
#include <vector>

namespace bone
{
/** The largest of 1, 2, 5 times a power of ten that is not above `most`; 0 where that is not positive and finite. */
double
NiceLength(double most);

/** The smallest of 1, 2, 5 times a power of ten that is not below `least`; 0 where that is not positive and finite. */
double
NiceStep(double least);

/** The multiples of a 1-2-5 step within lower..upper, both included: about `most` of them and no more. Empty where the
 * range is empty or not finite. */
std::vector<double>
LinearTicks(double lower, double upper, int most);

/** Powers of ten within lower..upper, with their 2 and 5 fold where that gives no more than `most`, and every n-th
 * alone where there are more. Empty where the range is empty, not finite or not positive. */
std::vector<double>
LogTicks(double lower, double upper, int most);

/** The value rounded to a 1-2-5 step of at most a fiftieth of a range, that pictures tell short numbers; as it is where
 * the range is not positive and finite. */
double
RoundInRange(double value, double range);

/** A number as short as tells so many digits of it, without an exponent from 0.0001 to a million: "0.05", "-120",
 * "1e-06". */
std::string
TickText(double value, int digits = 4);

/** The texts of ascending ticks, of as many digits as tell each to a hundredth of their distance. */
std::vector<std::string>
TickTexts(const std::vector<double> & ticks);
} // namespace bone

#endif
