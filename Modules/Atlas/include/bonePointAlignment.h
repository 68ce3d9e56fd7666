/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePointAlignment_h
#define bonePointAlignment_h

#include "boneAlignmentKind.h"
#include "boneTypes.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace bone
{
/** x -> linear x + translation, mm. */
struct AffineMap
{
  Eigen::Matrix3d linear{ Eigen::Matrix3d::Identity() };
  Vector3         translation{ Vector3::Zero() };

  Vector3
  operator()(const Vector3 & x) const
  {
    return linear * x + translation;
  }
  AffineMap
  Inverse() const
  {
    const Eigen::Matrix3d inverse = linear.inverse();
    return { inverse, -(inverse * translation) };
  }
};

/** this after that: x -> outer(inner(x)). */
inline AffineMap
Compose(const AffineMap & outer, const AffineMap & inner)
{
  return { outer.linear * inner.linear, outer(inner.translation) };
}

/** \brief The map of the given kind that brings `from` nearest to `to`, in weighted least squares.
 *
 * Rigid and similarity are proper (no mirror): S. Umeyama, doi:10.1109/34.88573. Weights empty: all 1. Throws
 * std::invalid_argument where the lengths differ or there are no points. */
AffineMap
FitAlignment(const std::vector<Vector3> & from,
             const std::vector<Vector3> & to,
             AlignmentKind                kind,
             const std::vector<double> &  weights = {});

/** \brief The map of a shape to the frame of a mean: the inverse of the best fit of the mean to the shape.
 *
 * With Similarity, the difference of the moved shape to the mean is orthogonal to the mean (its tangent space, T. F.
 * Cootes & C. J. Taylor), so that a mean of shapes so aligned keeps its size. */
AffineMap
AlignToMean(const std::vector<Vector3> & shape, const std::vector<Vector3> & mean, AlignmentKind kind);

/** \struct ProcrustesResult
 * \brief Shapes brought together: generalised Procrustes analysis. */
struct ProcrustesResult
{
  std::vector<Vector3>   mean; ///< in the mean pose of the subjects, of their mean size
  std::vector<AffineMap> maps; ///< subject -> frame of the mean
  int                    iterations{ 0 };
};

/** Shapes of the same points that need not be in memory at once. */
struct ShapeSource
{
  std::size_t                                                      count{ 0 };
  std::function<void(std::size_t i, std::vector<Vector3> & shape)> load; ///< called in ascending order within a pass
};

/** \brief Aligns shapes to their mean, in turn, until the mean stays (J. C. Gower, doi:10.1007/BF02291478).
 *
 * Every turn is a pass over the source. The mean's frame is the mean of the subjects' own: neither the order of
 * subjects nor, up to that frame, their poses matter. With Similarity the mean keeps the geometric mean of the sizes.
 * With None all maps are the identity. Throws std::invalid_argument where point counts differ. */
ProcrustesResult
AlignShapes(const ShapeSource & source, AlignmentKind kind);

/** The same for shapes in memory, which are moved. */
ProcrustesResult
AlignShapes(std::vector<std::vector<Vector3>> & shapes, AlignmentKind kind);

/** The points moved by the map. */
void
Apply(const AffineMap & map, std::vector<Vector3> & points);
} // namespace bone

#endif
