/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCorticalThickness_h
#define boneCorticalThickness_h

#include "boneCorticalFit.h"
#include "boneCorticalThicknessParameters.h"
#include "boneExecution.h"
#include "boneTriangleSurface.h"
#include "boneVoxelGrid.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <vector>

namespace bone
{
/** Standard deviations (mm) of a blur that differs between the slices' plane and across. */
struct CTBlur
{
  double  inPlane{ 0.0 };
  double  across{ 0.0 };
  Vector3 axis{
    Vector3::UnitZ()
  }; ///< across the slices: the image's axis of the largest spacing, of equal ones the last

  /** Along a unit vector. */
  double
  Along(const Vector3 & direction) const;

  bool
  operator==(const CTBlur & other) const
  {
    return inPlane == other.inPlane && across == other.across && axis == other.axis;
  }
};

/** Cortical thickness at the points of a surface. */
struct CorticalThicknessMap
{
  TriangleSurface             surface;
  std::vector<IdType>         pointId;   ///< the mesh's id of each point
  std::vector<double>         thickness; ///< mm; NaN where the status is not Found
  std::vector<double>         fitted;    ///< the same without replaced outliers and smoothing
  std::vector<double>         density;   ///< HU, of the cortex; NaN likewise
  std::vector<CorticalStatus> status;
  CTBlur                      blur;
  double                      corticalDensity{ 0.0 }; ///< HU, where the cortex is thin
  std::size_t                 thickPoints{ 0 };       ///< where the density, and the blur, were fitted
  std::size_t                 outliers{ 0 };          ///< replaced by the median of their neighbours

  /** Maps with points that have no result are not equal, as NaN is not. */
  bool
  operator==(const CorticalThicknessMap & other) const
  {
    return surface == other.surface && pointId == other.pointId && thickness == other.thickness &&
           fitted == other.fitted && density == other.density && status == other.status && blur == other.blur &&
           corticalDensity == other.corticalDensity;
  }
  bool
  operator!=(const CorticalThicknessMap & other) const
  {
    return !(*this == other);
  }
};

/** Voxels of a CT: where they lie, and the value (HU) of each, counted with the first axis fastest. */
struct CTVoxels
{
  VoxelGrid                          grid;
  std::function<double(std::size_t)> value;
};

/** \brief Cortical thickness along the inward normal at each point of a mesh's exterior surface, from the CT.
 *
 *  1. For each voxel near the surface: its depth below the surface and its nearest point (foot) on it. The voxels whose
 *     foot lies within `radius` of a point are its bundle of normals. Their values are fitted as they are, at the
 * depths of their centres: no interpolation blurs them, and voxels of many depths resolve more than a single line.
 *     Where the sides of a ridge meet, voxels along the normal itself go on, to the middle of the bone.
 *  2. \ref FitCortex with density and blur free. Where the cortex is thicker than five standard deviations of its blur
 *     both are reliable. The blur of the image, in the slices' plane and across, is fitted to these; the median of
 * their densities is that of thin cortex. Layers of less than 0.75 of the 90 percentile of all thick layers' densities
 *     are left out, as trabecular bone.
 *  3. The fit again with that blur, and with that density where no thick cortex was found.
 *  4. A thickness that is far from the median of its neighbours becomes that median; then steps of half the way to the
 *     neighbours' mean. Points without a result stay so.
 *
 * A plate whose two cortices meet has status Solid, a flat cut through the bone (\ref
 * FindSurfaces) Outside.
 *
 * Throws std::invalid_argument where blur or density are to be estimated and fewer than 20 points have a thick cortex,
 * where no point of the mesh lies in the image, or where a voxel near the surface is not finite; itk::ExceptionObject
 * where the surface is not closed. The result does not depend on the number of threads. */
CorticalThicknessMap
MapCorticalThickness(const MeshArrays &                  mesh,
                     const CTVoxels &                    ct,
                     const CorticalThicknessParameters & parameters,
                     const Execution &                   execution = Execution());

/** \brief Mean, median, 5 and 95 percentile of the thickness, each point counted with its area; and the share of the
 * area by status; blur (full width at half maximum) and density that were used. */
nlohmann::json
ReportThickness(const CorticalThicknessMap & map);
} // namespace bone

#endif
