/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourShape_h
#define boneContourShape_h

#include "boneContourStack.h"
#include "boneTriangleTree.h"

#include <optional>

namespace bone
{
/** \class ContourShape
 * \brief The shape that contours on parallel slices describe: signed distances, interpolated between slices.
 *
 * The body of level r is all material of regions of at least r. On a slice its signed distance is exact; between two
 * slices that both have it, it is interpolated linearly (S. P. Raya, J. K. Udupa, "Shape-based interpolation of
 * multidimensional objects", 1990). Const use is safe from many threads. */
class ContourShape
{
public:
  /** \param stack  contours as of \ref ContourStack, verified; axes are left out. */
  explicit ContourShape(const ContourStack & stack);

  struct Value
  {
    double  distance; ///< mm, negative inside
    Vector3 gradient;
  };

  /** Interpolated distance and its gradient; none above the last slice, below the first, and next to a slice
   * without the body. Between slices it is no Euclidean distance, but its zero is the shape's surface. */
  std::optional<Value>
  Evaluate(int level, const Vector3 & x) const;

  /** A point of the surface of a body where it is known: on a contour. */
  struct Sample
  {
    Vector3 place;
    Vector3 outward; ///< unit normal of the contour, in its plane
    double  weight;  ///< mm^2, length of contour times the distance of slices that it stands for
  };

  /** Points on the contours of a body of level r on all slices, evenly along each: at most `spacing` mm apart, and at
   * least three. */
  std::vector<Sample>
  SampleContours(int level, double spacing) const;

  /** Unit normal of the slices. */
  const Vector3 &
  GetNormal() const
  {
    return m_Frame->GetNormal();
  }

  /** Length of all contours of a body of level r, mm. */
  double
  GetContourLength(int level) const;

  /** The largest level that a slice has; 0 for none. */
  int
  GetLevels() const;

private:
  /** The body of one level on one slice. */
  struct Section
  {
    std::vector<std::vector<Vector2>> polygons;
    std::vector<double>               sides; ///< of each polygon: 1 where the body lies on its left, else -1
    TriangleTree                      tree;  ///< of its segments, in the plane z = 0

    /** Distance, and its gradient in the plane. */
    std::pair<double, Vector2>
    Evaluate(const Vector2 & q) const;
  };

  /** Calls visit(slice, section) for each slice that has the level. */
  template <typename TVisit>
  void
  ForEachSection(int level, TVisit visit) const;

  ContourStack::ConstPointer        m_Frame; ///< of the stack, without its slices
  std::vector<double>               m_Heights;
  std::vector<std::vector<Section>> m_Sections; ///< by slice, by level less 1
};
} // namespace bone

#endif
