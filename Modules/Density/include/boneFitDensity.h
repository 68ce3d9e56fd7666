/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFitDensity_h
#define boneFitDensity_h

#include "boneDensityFitParameters.h"
#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "boneOutlineContrast.h"
#include "boneVoxelGrid.h"

#include <functional>
#include <string>

namespace bone
{
/** Values of an image at places in index coordinates, counted from the grid's first voxel. Called from many threads. */
using ImageSampler = std::function<void(const Vector3 * indices, std::size_t count, double * values)>;

/** What is fitted to. */
struct DensityFitImage
{
  VoxelGrid    grid;
  ImageSampler interpolated;
  ImageSampler voxels;  ///< the fit asks at voxel centres only
  ImageSampler weights; ///< empty: all alike
};

/** What a fit found. */
struct DensityFitReport
{
  std::size_t samples{ 0 };
  std::size_t outside{ 0 };            ///< samples beyond the image's border
  bool        finite{ true };          ///< all values used were
  std::size_t voxels{ 0 };             ///< voxel centres in tetrahedra
  std::size_t sparse{ 0 };             ///< tetrahedra with fewer voxels than coefficients
  std::size_t unsupported{ 0 };        ///< tetrahedra in which all weights are 0, fitted as if they were 1
  std::size_t limited{ 0 };            ///< tetrahedra whose control values were drawn in
  double      overshootMedian{ 0.0 };  ///< of control values beyond the data, in ranges of the tetrahedron's data
  double      overshoot90{ 0.0 };      ///< its 90th percentile
  double      overshootMaximum{ 0.0 }; ///< its maximum
};

/** Which of the parameters do not go together, and what to do, in one line without a full stop; empty where they do. */
std::string
FindConflict(const DensityFitParameters & parameters);

/** One in five of the voxels of a block, so that no two of them share a face: those left out where a fit is judged. */
inline bool
IsHeldOut(int i, int j, int k)
{
  return (i + 2 * j + 3 * k) % 5 == 0;
}

/** Replaces the mesh's degrees and coefficients by a fit to the image; quantity and all else stay as they are. The
 * result does not depend on the number of threads. Values that are not finite are reported, and the coefficients are
 * then of no use. The work of DensityFitFilter on plain arrays. Throws as DensityFitPlan. */
DensityFitReport
FitDensity(MeshArrays &                 mesh,
           const DensityFitImage &      image,
           const DensityFitParameters & parameters,
           const Execution &            execution);

/** What the image has on both sides of the mesh's surface, by one place a face. */
OutlineContrast
MeasureSurfaceContrast(const MeshArrays & mesh, const VoxelGrid & grid, const ImageSampler & values);

/** Draws control values of a polynomial in until none lies further than `margin` beyond [low, high]: parts of the
 * highest degrees are reduced first, and the mean is kept. Returns whether there was anything to do. */
bool
LimitControlValues(int degree, double low, double high, double margin, double * coefficients);
} // namespace bone

#endif
