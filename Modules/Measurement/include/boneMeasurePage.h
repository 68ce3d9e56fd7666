/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeasurePage_h
#define boneMeasurePage_h

#include "boneMeasureReport.h"
#include "boneReportPage.h"

namespace bone
{
/** A page of measures: each with value, unit and definition, what could not be measured and why, and the model with its
 * landmarks; a model without tetrahedra, as where a surface was measured, is not shown. The caller adds warnings and
 * provenance. */
ReportPage
MakeMeasurePage(const std::string & name, const MeasureReport & report, const MeshArrays & model);
} // namespace bone

#endif
