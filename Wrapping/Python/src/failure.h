/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef failure_h
#define failure_h

#include <stdexcept>

namespace bone::python
{
/** Becomes bonetk.UsageError: a call that cannot be meant. One line. */
class UsageFailure : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/** Becomes bonetk.DataError: data are not what the work needs. One line. */
class DataFailure : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};
} // namespace bone::python

#endif
