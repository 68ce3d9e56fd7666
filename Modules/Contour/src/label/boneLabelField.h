/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelField_h
#define boneLabelField_h

#include "boneContourExtraction.h"

namespace bone
{
/** \class LabelField
 * \brief A smooth signed distance (mm, positive inside) to the surface of a binary label, between voxels trilinear.
 *
 * The exact distance between voxel centres (P. F. Felzenszwalb, D. P. Huttenlocher, doi:10.4086/toc.2012.v008a019) is
 * smoothed by a Gaussian of `sigma` voxels along each axis and then held at its sign: a voxel of the label stays
 * inside, another outside, so that thin plates and narrow gaps survive. */
class LabelField
{
public:
  /** `inside` holds box.Count() flags, the first axis fastest. Non-zero: the label. Borders are replicated: a label
   * that leaves the box is not closed there. */
  LabelField(const VoxelBox &                   box,
             const std::vector<unsigned char> & inside,
             double                             sigma,
             const Execution &                  execution);

  /** Value at a physical point. Beyond half a voxel outside the box it is negative. */
  double
  Sample(const Vector3 & p) const;

  /** Values at the nodes of a grid in the plane of the unit vectors u, v at `height` along their normal. */
  PlaneField
  SamplePlane(const PlaneGrid & grid, const Vector3 & u, const Vector3 & v, double height) const;

  /** Area (mm^2) of the label in a plane, from its indicator at the grid's nodes, between voxels trilinear. */
  double
  LabelArea(const PlaneGrid & grid, const Vector3 & u, const Vector3 & v, double height) const;

private:
  Vector3
  ToIndex(const Vector3 & p) const;
  /** How far (mm) an index lies outside the voxels of the box; 0 inside. */
  double
  Beyond(const Vector3 & x) const;
  template <typename TValue>
  double
  Interpolate(const std::vector<TValue> & values, const Vector3 & x) const;

  VoxelBox                   m_Box;
  Eigen::Matrix3d            m_ToIndex;
  std::vector<unsigned char> m_Inside;
  std::vector<float>         m_Values;
};
} // namespace bone

#endif
