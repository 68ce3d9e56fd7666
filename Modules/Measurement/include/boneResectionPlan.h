/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneResectionPlan_h
#define boneResectionPlan_h

#include "boneCutIntegrals.h"
#include "boneMeasure.h"

namespace bone
{
/** Area and moments of a plane section, of the bone or weighted with its density. */
struct SectionMoments
{
  double  area{ 0.0 };                 ///< mm^2; weighted: density units times mm^2
  Vector3 centroid{ Vector3::Zero() }; ///< mm
  double  largest{ 0.0 };  ///< second moment about the axis through the centroid that has the largest, mm^4;
                           ///< weighted: density units times mm^4
  double  smallest{ 0.0 }; ///< about the axis across, in the plane
  Vector3 largestAxis{ Vector3::Zero() }; ///< unit vector, in the plane
};

/** What a plane cuts of a bone. */
struct SectionProperties
{
  SectionMoments shape;
  SectionMoments density; ///< weighted with the density; all 0 without one
};

/** \brief Area, centroid and second moments of the section of a mesh with a plane, and the same weighted with the
 * density.
 *
 * Exact up to rounding: the section is a polygon in each tetrahedron, on whose triangles Gauss' formula with six points
 * along either direction is exact for a polynomial of the highest degree times a square. Without density the weighted
 * ones are 0. Throws std::invalid_argument where the plane does not cut the mesh. */
SectionProperties
MeasureSection(const MeshArrays & mesh, const HalfSpace & plane);

/** \brief A resection: what lies on the side of a plane that its normal points to is removed.
 *
 * NAME.removed.volume, .mass, .meanDensity and those of its regions, the same of NAME.kept, NAME.section.area,
 * .centroid, .largestSecondMoment, .smallestSecondMoment, .largestAxis, .densityWeightedArea,
 * .densityWeightedLargestSecondMoment, .densityWeightedSmallestSecondMoment. Throws std::invalid_argument where the
 * plane does not cut the mesh, or the normal is 0. */
MeasureList
PlanResection(const MeshArrays &  mesh,
              const Vector3 &     point,
              const Vector3 &     normal,
              const std::string & name = "resection");
} // namespace bone

#endif
