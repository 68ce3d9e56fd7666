/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePlacement_h
#define bonePlacement_h

#include "boneContourStack.h"
#include "boneDensityHierarchy.h"
#include "boneMeshArrays.h"

#include <itkImageBase.h>

namespace bone
{
/** \brief Where something lies in space: its point q is at direction * q + origin (mm). The direction is orthogonal, a
 * reflection or not. The default changes nothing. */
struct Placement
{
  Eigen::Matrix3d direction{ Eigen::Matrix3d::Identity() };
  Vector3         origin{ Vector3::Zero() };

  Vector3
  operator()(const Vector3 & q) const
  {
    return direction * q + origin;
  }
  bool
  IsReflection() const
  {
    return direction.determinant() < 0.0;
  }
  /** From space to its own place. */
  Placement
  Inverse() const
  {
    return { direction.transpose(), -(direction.transpose() * origin) };
  }
};

/** Whether the largest component is positive. */
bool
PointsForward(const Vector3 & direction);

bool
operator==(const Placement & a, const Placement & b);
inline bool
operator!=(const Placement & a, const Placement & b)
{
  return !(a == b);
}

/** \defgroup PutInPlace Things put in their place
 * A reflection turns tetrahedra and contours inside out; they are given their orientation again: each tetrahedron's
 * first two vertices change places, with its neighbours and coefficients, and closed contours run the other way round
 * from the same first point.
 * \{ */
/** The place of an image's grid: a point of the grid is index times spacing, counted from the image's first voxel. */
Placement
PlacementOf(const itk::ImageBase<3> & image);

MeshArrays
Place(MeshArrays mesh, const Placement & placement);

/** In the order of slices in which their normal points forward (\ref PointsForward). */
ContourStack::Pointer
Place(const ContourStack & contours, const Placement & placement);

DensityHierarchy<>::Pointer
Place(const DensityHierarchy<> & hierarchy, const Placement & placement);
/** \} */
} // namespace bone

#endif
