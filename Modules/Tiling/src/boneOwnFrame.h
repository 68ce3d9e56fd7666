/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneOwnFrame_h
#define boneOwnFrame_h

#include "boneContourStack.h"

#include <map>

namespace bone
{
namespace tiling
{
/** \brief A stack of contours in an order and with first points that depend on where the contours lie to each other
 * alone, and in such a frame, with coordinates rounded to 1e-8 mm: turning or renumbering a stack changes nothing
 * here. */
class OwnFrame
{
public:
  /** Where not `rounded`, coordinates are those in space; only the order and the stack's axes are its own. */
  OwnFrame(const ContourStack & stack, bool rounded);

  /** The stack in the frame. */
  const ContourStack &
  GetStack() const
  {
    return *m_Stack;
  }

  /** The place in space of a point in the frame, but for rounding. */
  Vector3
  ToSpace(const Vector3 & p) const;

  /** The same; points of the contours are exactly those that were given. */
  Vector3
  ToGivenPlace(const Vector3 & p) const;

private:
  ContourStack::Pointer                    m_Own;   ///< in space
  ContourStack::Pointer                    m_Stack; ///< in the frame
  std::map<std::array<double, 3>, Vector3> m_Given; ///< points of the contours, by their coordinates in the frame
};
} // namespace tiling
} // namespace bone

#endif
