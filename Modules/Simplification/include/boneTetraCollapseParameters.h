/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraCollapseParameters_h
#define boneTetraCollapseParameters_h

#include "boneBernstein.h"
#include "boneParameters.h"
#include "boneTypes.h"

namespace bone
{
// clang-format off
#define BONE_TETRA_COLLAPSE_PARAMETERS(value, flag) \
  value(std::vector<IdType>, levels, Levels, std::vector<IdType>(), ParameterRange::AtLeast(1), "", "tetrahedra", \
    "Tetrahedra of each coarser level, in order") \
  value(std::vector<double>, maximumDensityErrors, MaximumDensityErrors, std::vector<double>(), \
    ParameterRange::NotNegativeOrInfinite(), "density units", "max-density-error", \
    "Bound on the root mean square density error of each coarser level") \
  value(std::vector<double>, maximumCellErrors, MaximumCellErrors, std::vector<double>(), \
    ParameterRange::NotNegativeOrInfinite(), "density units", "max-cell-error", \
    "Bound on the root mean square density error in each new tetrahedron of each coarser level") \
  value(std::vector<double>, maximumSurfaceDistances, MaximumSurfaceDistances, std::vector<double>(), \
    ParameterRange::NotNegativeOrInfinite(), "mm", "max-surface-distance", \
    "Bound on the distance of boundary and interfaces of each coarser level to the first, and back") \
  value(double, maximumVolumeChange, MaximumVolumeChange, 0.03, ParameterRange::NotNegativeOrInfinite(), "share", \
    "max-volume-change", "Bound on the change of each region's volume") \
  value(double, minimumDihedralAngle, MinimumDihedralAngle, 0.05235987755982988, ParameterRange::Between(0.0, 1.23), \
    "rad", "min-angle", "No dihedral angle falls below this and what was there") \
  value(double, minimumCorticalDihedralAngle, MinimumCorticalDihedralAngle, 0.02617993877991494, \
    ParameterRange::Between(0.0, 1.23), "rad", "min-cortical-angle", \
    "The same in the cortical layer, which may be thin; half of --min-angle where that alone is given") \
  flag(improveAngles, ImproveAngles, false, "improve-angles", \
    "Levels for finite elements: points move and edges flip so that angles are at least the next two, and cells not long") \
  value(double, wantedDihedralAngle, WantedDihedralAngle, 0.13962634015954636, ParameterRange::Between(0.0, 1.23), \
    "rad", "wanted-angle", "With --improve-angles: dihedral angle that cells are to have at least") \
  value(double, wantedCorticalDihedralAngle, WantedCorticalDihedralAngle, 0.08726646259971647, \
    ParameterRange::Between(0.0, 1.23), "rad", "wanted-cortical-angle", \
    "The same in the cortical layer") \
  value(int, maximumDegree, MaximumDegree, -1, ParameterRange::Between(-1, MaximumBernsteinDegree), "", "max-degree", \
    "Degree to which polynomials may be raised to keep to --max-density-error; -1: not raised") \
  value(double, densityWeight, DensityWeight, 3.0, ParameterRange::NotNegative(), "", "density-weight", \
    "Weight of the squared density error, as a share of the density's range, in the cost of a collapse") \
  value(double, surfaceWeight, SurfaceWeight, 1.0, ParameterRange::NotNegative(), "1/mm", "surface-weight", \
    "Weight of the squared distance of boundary and interfaces in the cost of a collapse") \
  value(double, volumeWeight, VolumeWeight, 200.0, ParameterRange::NotNegative(), "", "volume-weight", \
    "Weight of the growth of each region's squared volume error over its volume in the cost of a collapse")
// clang-format on

/** Parameters of TetraCollapseFilter. */
BONE_PARAMETER_STRUCT(TetraCollapseParameters, BONE_TETRA_COLLAPSE_PARAMETERS);
} // namespace bone

#endif
