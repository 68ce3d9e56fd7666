/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef reports_h
#define reports_h

#include "filters.h"

#include "boneAtlasRegistration.h"
#include "boneContourExtraction.h"
#include "boneContourResampleFilter.h"
#include "boneFitDensity.h"
#include "boneMeshImprovement.h"
#include "boneRadiographPreprocess.h"
#include "boneTetraCollapseFilter.h"
#include "boneTetraFlips.h"
#include "boneTilingReport.h"

namespace bone::python
{
/** \defgroup Reports What filters say of their last run, as dicts
 * \{ */
py::dict
DescribeReport(const ExtractionReport & report);
py::dict
DescribeReport(const SamplingReport & report);
py::dict
DescribeReport(const TilingReport & report);
py::dict
DescribeReport(const SmoothingReport & report);
py::dict
DescribeReport(const FlipReport & report);
py::dict
DescribeReport(const ImprovementReport & report);
py::dict
DescribeReport(const DensityFitReport & report);
py::dict
DescribeReport(const RegistrationReport & report);
py::dict
DescribeReport(const RadiographPreprocessReport & report);
py::dict
DescribeReport(const TetraCollapseFilter<Mesh>::LevelReport & report);
template <typename T>
py::list
DescribeReport(const std::vector<T> & reports)
{
  py::list list;
  for (const T & report : reports)
  {
    list.append(DescribeReport(report));
  }
  return list;
}

/** The property `report` of a filter that has GetReport. */
template <typename TFilter>
void
AddReport(FilterClass<TFilter> & filter, const char * doc)
{
  filter.def_property_readonly(
    "report", [](const TFilter & self) { return DescribeReport(self.GetReport()); }, doc);
  constexpr bool list = std::is_same_v<decltype(DescribeReport(std::declval<const TFilter &>().GetReport())), py::list>;
  AddMember(filter, "report", list ? "list[dict[str, Any]]" : "dict[str, Any]", true);
}
/** \} */
} // namespace bone::python

#endif
