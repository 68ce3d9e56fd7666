/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourSamples_h
#define boneContourSamples_h

#include "boneContourShape.h"
#include "boneExecution.h"
#include "boneSurfaceGrid.h"
#include "boneTetraComplex.h"

#include <vector>

namespace bone
{
/** \class ContourSamples
 * \brief Points of contours, each with the triangle of a mesh's surfaces that it belongs to.
 *
 * Contours say where the surfaces are on their slices, exactly; between slices nothing does. There are several points
 * to a triangle. The body of a level is bounded by all surfaces between a region below the level and one of it or
 * above. */
class ContourSamples
{
public:
  ContourSamples(const TetraComplex & complex, const ContourShape & shape, const Execution & execution = {});

  /** A point of a contour and the triangle nearest to it. */
  struct Match
  {
    const ContourShape::Sample * sample;
    TriangleIds                  triangle; ///< outward from the cell that carries it
    Vector3                      foot;     ///< on the triangle
    Vector3                      normal;   ///< unit, of the triangle
    double                       weight;   ///< mm^2, see FindMatches
  };

  /** Points of contours near surfaces that look the same way; contours that the mesh has left out find none. A match
   * counts for length of contour times distance of slices, over the squared sine of the angle between surface and
   * slice: what should be small is the distance within the slice, where the surface may be far though it is near. */
  std::vector<Match>
  FindMatches(const TetraComplex & complex) const;

private:
  Execution                                      m_Execution;
  std::vector<std::vector<ContourShape::Sample>> m_Levels; ///< by level less 1
};
} // namespace bone

#endif
