/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSeeds_h
#define boneSeeds_h

#include "boneLandmarkIO.h"
#include "boneTriangleSurface.h"

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace bone
{
/** Why a primitive cannot be fitted. */
struct MissingSeed : std::runtime_error
{
  using std::runtime_error::runtime_error;
};

/** \struct SurfaceSeeds
 * \brief A surface, points for integrals over it, and the landmarks that fits on it start from. */
struct SurfaceSeeds
{
  /** The surface must outlive this. Of landmarks of one name the first counts. */
  SurfaceSeeds(const TriangleSurface & closed, const std::vector<Landmark> & landmarks, double farthest);

  /** Throws MissingSeed where the landmark was not given, or lies beyond the surface and further from it than
   * `farthest` and `beyond` (mm), how far in the open it should lie. */
  const Vector3 &
  Find(const std::string & name, double beyond = 0.0) const;

  const TriangleSurface & surface;
  /** The middles of each triangle's edges, with a third of its area each (mm^2): sums over them are exact integrals of
   * quadratic functions over the surface. Fits to them do not depend on whether the triangles' corners lie on the bone,
   * or outside so that the triangles lie on it in the mean. */
  std::vector<Vector3> middles;
  std::vector<double>  areas;

private:
  struct Seed
  {
    Vector3 point;
    double  distance; // mm beyond the surface; 0 within
  };
  std::map<std::string, Seed> m_Seeds;
  double                      m_Farthest;
};
} // namespace bone

#endif
