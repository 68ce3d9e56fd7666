/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef analysis_h
#define analysis_h

#include "objects.h"

#include "boneLandmarkIO.h"

namespace bone::python
{
/** Of a dict of name and point. */
std::vector<Landmark>
ToLandmarks(const py::dict & points);

void
BindAnalysis(py::module_ & m);
void
BindFiniteElements(py::module_ & m);
} // namespace bone::python

#endif
