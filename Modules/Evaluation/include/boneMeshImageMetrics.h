/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshImageMetrics_h
#define boneMeshImageMetrics_h

#include "boneImageIO.h"
#include "boneDensityEvaluation.h"
#include "boneVoxelFaces.h"

namespace bone
{
/** \defgroup MeshImageMetrics How well a mesh agrees with the image it was made from
 * A mask is 0 outside the bone and not 0 in it. Voxels are in a mesh where their centres are.
 * \{ */

/** Dice overlap of the voxels in a mesh, which has a density, with those of the mask. */
double
DiceOverlap(const MeshArrays & mesh, const LabelImage * mask);

/** 1 at the voxels of a grid that are in a mesh, which has a density. */
LabelImage::Pointer
MaskOfMesh(const MeshArrays & mesh, const itk::ImageBase<3> * grid);

/** Distances in mm. */
struct SurfaceDistance
{
  double mean{ 0.0 };
  double percentile95{ 0.0 };
  double maximum{ 0.0 };
};

/** Distances between the mesh's boundary and the surface of the mask, which is that of its voxels' faces; faces at the
 * image's border count. The mesh's boundary is sampled about every 0.5 mm, the mask's at its faces' centres. */
struct SurfaceDistances
{
  SurfaceDistance meshToMask;
  SurfaceDistance maskToMesh;
};

/** \brief Measures the distances of meshes to the surface of one mask, on all threads. */
class SurfaceDistanceMeter
{
public:
  explicit SurfaceDistanceMeter(const LabelImage * mask);

  SurfaceDistances
  Measure(const MeshArrays & mesh) const;

private:
  VoxelFaces           m_Faces;
  std::vector<Vector3> m_Centres; ///< of the faces
};

/** Density of the model against that of the CT, over the voxels that lie in the model and in the mask. */
DensityComparison
CompareWithImage(const MeshArrays & mesh, const CTImage * ct, const LabelImage * mask);

/** Mean absolute density error, in percent of the range, of the model cut to degrees 0, 1, ... below the largest of its
 * cells: of the nearest polynomial of that degree in each tetrahedron. */
std::vector<double>
LowerDegreeErrors(const MeshArrays & mesh, const CTImage * ct, const LabelImage * mask);

/** 1st and 99th percentile of the image in the mask. */
std::array<double, 2>
PercentileRange(const CTImage * ct, const LabelImage * mask);

/** Mean absolute difference of two radiographs of one geometry over the pixels where the reference is not 0, in percent
 * of the reference's 1..99 % range there. */
double
RadiographDifferencePercent(const CTImage * reference, const CTImage * radiograph);
/** \} */
} // namespace bone

#endif
