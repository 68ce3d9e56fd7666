/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef radiograph_source_h
#define radiograph_source_h

#include "filters.h"

#include "boneRadiographSource.h"

namespace bone::python
{
/** Geometry, conversion to attenuation and output of a source of radiographs. */
template <typename TFilter>
void
AddRadiographSource(FilterClass<TFilter> & filter)
{
  AddInput<XRayGeometry>(
    filter,
    "geometry",
    [](const TFilter & self) { return self.GetGeometry(); },
    [](TFilter & self, const XRayGeometry * geometry) { self.SetGeometry(geometry); },
    "XRayGeometry.");
  AddParameters<RadiographParameters>(
    filter,
    [](const TFilter & self) -> const RadiographParameters & { return self.GetRadiographParameters(); },
    [](TFilter & self, const RadiographParameters & parameters) {
      static_cast<RadiographSource<CTImage> &>(self).SetParameters(parameters);
    });
  AddOutput(
    filter,
    "output",
    [](TFilter & self) { return self.GetOutput(); },
    "Image of 1 x rows x columns line integrals, on the detector; in density units times mm, or without unit where HU "
    "are turned into attenuation.");
}
} // namespace bone::python

#endif
