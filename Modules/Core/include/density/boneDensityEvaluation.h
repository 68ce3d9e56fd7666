/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityEvaluation_h
#define boneDensityEvaluation_h

#include "boneExecution.h"
#include "boneTetraLocator.h"
#include "boneVoxelGrid.h"

#include <functional>

namespace bone
{
/** Density at a located place, in density units. The mesh must hold a density. */
double
DensityAt(const MeshArrays & mesh, const CellLocation & place);

/** Gradient of the density at a located place, density units per mm. */
Vector3
DensityGradientAt(const MeshArrays & mesh, const CellLocation & place);

/** One place of a profile. */
struct DensityProfilePoint
{
  Vector3 point{ Vector3::Zero() };    ///< mm
  double  distance{ 0.0 };             ///< mm from the profile's start
  IdType  cell{ -1 };                  ///< -1: outside the body
  double  value{ 0.0 };                ///< density units; NaN outside
  Vector3 gradient{ Vector3::Zero() }; ///< density units per mm; NaN outside
};

/** Density along the segment from `from` to `to`, at `count` >= 2 evenly spaced places with both ends. Each place is
 * searched for from the tetrahedron of the one before. The locator must be of the same mesh. Throws
 * std::invalid_argument where the mesh holds no density or count is below 2. */
std::vector<DensityProfilePoint>
DensityProfile(const MeshArrays &   mesh,
               const TetraLocator & locator,
               const Vector3 &      from,
               const Vector3 &      to,
               std::size_t          count);

/** Density of one region in closed form. */
struct RegionDensity
{
  int         region{ 0 };
  std::size_t tetrahedra{ 0 };
  double      volume{ 0.0 };            ///< mm^3
  double      mass{ 0.0 };              ///< integral of the density, density units times mm^3
  double      mean{ 0.0 };              ///< density units
  double      standardDeviation{ 0.0 }; ///< of the density over the region's volume
};

/** "cortical", "trabecular", "medullary"; "outside", and "further layer" for those deeper than the cavity. */
const char *
RegionName(int region);

/** The unit of density values for people: that of DensityQuantityName, or "density units" where the quantity is not
 * known. */
std::string
DensityUnitName(DensityQuantity quantity);

/** One entry for each region that occurs, ascending; a mesh without regions is one region 0. Exact up to rounding: the
 * integrals are those of \ref Bernstein. Throws std::invalid_argument where the mesh holds no density. */
std::vector<RegionDensity>
MeasureRegions(const MeshArrays & mesh);

/** Difference of a model to an image, at voxel centres. */
struct DensityComparison
{
  std::size_t voxels{ 0 };                ///< voxels that count and lie in the mesh
  std::size_t uncovered{ 0 };             ///< voxels that count and do not
  double      meanAbsolute{ 0.0 };        ///< of |model - image|
  double      standardDeviation{ 0.0 };   ///< of |model - image|
  double      rootMeanSquare{ 0.0 };      ///< of model - image
  double      bias{ 0.0 };                ///< mean of model - image
  double      range{ 0.0 };               ///< 1st to 99th percentile of the image in the voxels compared
  double      meanAbsolutePercent{ 0.0 }; ///< of the range
};

/** Says whether the voxel at an offset (i fastest) counts, and writes its value. Called from many threads. */
using VoxelReference = std::function<bool(std::size_t offset, double & value)>;

/** Compares the model with the image `reference` on a grid; every voxel centre of the grid is asked for. The result
 * does not depend on the number of threads. Throws std::invalid_argument as DensityRaster. */
DensityComparison
CompareDensity(const MeshArrays &     mesh,
               const VoxelGrid &      grid,
               const VoxelReference & reference,
               const Execution &      execution = {});
} // namespace bone

#endif
