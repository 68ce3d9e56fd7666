/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLayerDistance_h
#define boneLayerDistance_h

#include "bonePlaneField.h"

namespace bone
{
/** \class NearestOnPolygon
 * \brief Nearest points of a closed polygon, whose edges are looked through in boxes of sixteen. Keeps a pointer to it.
 */
class NearestOnPolygon
{
public:
  struct Found
  {
    double      distance{ 0.0 }; ///< mm
    Vector2     foot{ Vector2::Zero() };
    std::size_t edge{ 0 };
    double      along{ 0.0 }; ///< 0 .. 1
  };

  /** \pre the polygon is not empty. */
  explicit NearestOnPolygon(const Polygon & polygon);

  Found
  operator()(const Vector2 & q) const;

private:
  const Polygon *                  m_Polygon;
  std::vector<Eigen::AlignedBox2d> m_Boxes;
};

/** Least distance (mm) between two polygons that do not cross. */
double
DistanceBetween(const Polygon & a, const Polygon & b);

/** \brief Moves points of `inner` away from `fixed` until the polygons are at least `gap` (mm) apart.
 *
 * All of `inner` lies on one side of `fixed`, in it or (`inside` false) beside it. Points nearer than the gap move
 * along the line from their nearest point; so do the ends of an edge that a point of `fixed` is too near to. Returns
 * the number of moves, or -1 where the gap cannot be had in a few dozen passes; `inner` is then as it was. It may come
 * out crossing itself where it is narrower than the moves are long. */
int
MoveAway(Polygon & inner, const Polygon & fixed, bool inside, double gap);
} // namespace bone

#endif
