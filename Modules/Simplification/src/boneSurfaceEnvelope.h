/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceEnvelope_h
#define boneSurfaceEnvelope_h

#include "boneExecution.h"
#include "boneSurfaceGrid.h"
#include "boneTetraComplex.h"
#include "boneTriangleTree.h"

#include <map>
#include <memory>
#include <vector>

namespace bone
{
/** \class SurfaceEnvelope
 * \brief Decides whether a collapse keeps boundary, interfaces and flat cuts within a distance of those of the finest
 * level, both ways and at every point.
 *
 * The distance to a triangle is convex, so that of a triangle to another is largest at a corner. From the level to the
 * finest: a changed face is within the distance where one triangle of the finest surface is near enough to all three of
 * its corners, or where its centroid is nearer than the distance by more than its radius; otherwise its quarters must
 * be. From the finest to the level: each triangle of the finest level is known to a face that is near enough to its
 * corners, or is taken apart into quarters that are. What is not decided after \ref MaximumDepth quarterings is
 * refused, so that the bound holds strictly (to rounding). Cf. M. Tang, M. Lee, Y. J. Kim, "Interactive Hausdorff
 * distance computation for general polygonal models", 2009. */
class SurfaceEnvelope
{
public:
  static constexpr int MaximumDepth = 5;

  explicit SurfaceEnvelope(const TetraComplex & complex);

  /** Whether v -> w keeps the surfaces around v within \a distance. */
  bool
  Allows(const TetraComplex & complex, IdType v, IdType w, double distance) const;

  /** Follows a collapse that Allows() has agreed to; to be called before it is made. */
  void
  Commit(const TetraComplex & complex, IdType v, IdType w, double distance);

private:
  using Triangle = TriangleTree::Triangle;
  struct Face
  {
    TriangleIds key; ///< ascending
    int         surface;
    Triangle    corners;
  };
  struct Piece
  {
    Triangle corners;
    int      surface;
    int      depth;
  };
  struct Target
  {
    std::vector<Triangle> triangles;
    TriangleTree          tree;
  };
  /** Faces around v before a collapse, and those that come in their place or stay next to them. */
  struct Change
  {
    std::vector<TriangleIds> removed;
    std::vector<Face>        created;
    std::vector<Face>        kept;
  };

  Change
  ChangeOf(const TetraComplex & complex, IdType v, IdType w) const;
  bool
  IsNearFinest(const Target & target, const Triangle & corners, double distance, int depth) const;
  bool
  Place(const Piece &                                piece,
        const std::vector<Face> &                    faces,
        double                                       squared,
        std::vector<std::pair<TriangleIds, Piece>> & placed) const;

  std::shared_ptr<const std::vector<Target>> m_Finest; ///< of each surface
  std::map<TriangleIds, std::vector<Piece>>  m_Pieces; ///< of the finest level, by the face that they are near to
};

/** \brief Largest distance, both ways, of the surfaces of two meshes of the same body, mm.
 *
 * Surfaces are the boundaries of the unions of all regions from each one inward. The value is attained; the true
 * largest one is no more than \a tolerance above it. */
double
LargestSurfaceDistance(const MeshArrays & first,
                       const MeshArrays & second,
                       double             tolerance,
                       const Execution &  execution = Execution());
} // namespace bone

#endif
