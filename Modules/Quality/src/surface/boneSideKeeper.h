/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSideKeeper_h
#define boneSideKeeper_h

#include "boneLabelOutline.h"
#include "bonePointMover.h"

namespace bone
{
/** \class SideKeeper
 * \brief Moves the boundary of a mesh to the right side of the voxel centres that it passes closely on the wrong side.
 *
 * A fitted surface passes the centres of some voxels on the wrong side by a few hundredths of a millimetre. A move of
 * that size does not change the shape, and the overlap with the label grows. Centres that lie farther on the wrong side
 * are left, because contours and stiffness put the surface there. */
class SideKeeper
{
public:
  /** \param outline  must live as long. */
  explicit SideKeeper(const LabelOutline & outline)
    : m_Outline(outline)
  {}

  struct Parameters
  {
    double reach{ 0.06 };      ///< voxels that the boundary may be on the wrong side of a centre to be moved
    double margin{ 0.002 };    ///< voxels that it is then put on the right side
    double cosineFloor{ 1.0 }; ///< no angle below that of this and below what it was
  };

  /** Moves the points of the triangle nearest to each such centre, by least squares, where that leaves fewer centres on
   * the wrong side. Points of curves, corners and flat cuts stay. Returns the number of moves. Throws
   * itk::ExceptionObject where the boundary is not closed. */
  std::size_t
  Restore(TetraComplex &     complex,
          PointMover &       mover,
          const Parameters & parameters,
          const Execution &  execution = {}) const;

private:
  const LabelOutline & m_Outline;
};
} // namespace bone

#endif
