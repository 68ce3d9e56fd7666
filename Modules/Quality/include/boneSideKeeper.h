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
 * \brief Puts the boundary of a mesh between the voxels of a label that it should be between, where little is missing.
 *
 * A fitted surface passes the centres of some voxels by a hundredth of a millimetre on the wrong side: a move that
 * nobody sees, and overlap with the label is gained. Farther off, it has its reasons. */
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
  Restore(TetraComplex & complex, PointMover & mover, const Parameters & parameters) const;

private:
  const LabelOutline & m_Outline;
};
} // namespace bone

#endif
