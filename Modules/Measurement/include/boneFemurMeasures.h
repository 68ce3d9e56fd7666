/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFemurMeasures_h
#define boneFemurMeasures_h

#include "boneLandmarkIO.h"
#include "boneMeasure.h"
#include "bonePrimitiveFit.h"
#include "boneTriangleSurface.h"

#include <optional>

namespace bone
{
/** The neck at its narrowest cross-section. */
struct FemurNeck
{
  Vector3 centre{
    Vector3::Zero()
  }; ///< mm, mean of the centroids of the sections whose area is within 10 % of the least
  Vector3 axis{ Vector3::UnitX() }; ///< unit vector from there to the centre of the head
  double  narrowest{ 0.0 };         ///< mm along the axis from the centre of the head to the narrowest section
  double  area{ 0.0 };              ///< mm^2, of the narrowest section
  double  height{ 0.0 };            ///< mm, its extent in the plane of the axes of neck and shaft; 0 without a shaft
  double  depth{ 0.0 };             ///< mm, its extent across that plane; 0 without a shaft
};

/** The condyles from behind. */
struct FemurCondyles
{
  Vector3 medial{ Vector3::Zero() };    ///< mm, hindmost point of the medial condyle
  Vector3 lateral{ Vector3::Zero() };   ///< mm, that of the lateral one
  Vector3 centre{ Vector3::Zero() };    ///< mm, of the knee: centroid of the cross-section midway between the two
  Vector3 longAxis{ Vector3::UnitZ() }; ///< unit vector from there to the shaft's axis at `shaft_proximal`
  Vector3 anterior{ Vector3::UnitY() }; ///< unit vector, at right angles to the long axis and to the line of the points
  bool    right{ true };                ///< of the body; false: left
};

/** \struct FemurGeometry
 * \brief Primitives fitted to a femur, in its own space; what could not be fitted is left empty and has its reason. */
struct FemurGeometry
{
  std::optional<FittedSphere>  head;
  std::optional<FittedLine>    shaft; ///< direction: toward the head
  std::optional<FemurNeck>     neck;
  std::optional<FemurCondyles> condyles;
  std::string                  headReason;
  std::string                  shaftReason;
  std::string                  neckReason;
  std::string                  condylesReason;
};

/** Names of the landmarks that a femur's measures start from. */
const std::vector<std::string> &
FemurLandmarkNames();

/** \brief Fits a femur's primitives, from landmarks that are seeds: a few millimetres hardly matter.
 *
 * | landmark | where |
 * |---|---|
 * | `femoral_head` | near the centre of the head, within a third of its radius |
 * | `femoral_neck` | within the neck, near its middle |
 * | `shaft_proximal` | in the shaft, or on it, just below the lesser trochanter |
 * | `shaft_distal` | the same, where the part whose axis is taken ends: at mid-shaft |
 * | `medial_condyle`, `lateral_condyle` | near the hindmost point of each condyle, within 20 mm |
 *
 * - Head: the sphere of the half of the head that looks away from the neck, by the middles of its triangles' edges,
 * weighted with areas, robust (a fovea does not count).
 * - Shaft: the line of the centroids of 21 cross-sections at right angles to it, between the heights of the two
 * landmarks.
 * - Neck: the line from the centre of the head through the centroids of the narrowest cross-sections at right angles to
 *   it.
 * - Condyles: the two points that a plane along the long axis touches from behind, which is the side of the
 *   cross-section's centroid on which the condyles' landmarks lie.
 *
 * The result moves with the bone; a mirrored bone has the mirrored result. A landmark further than `farthest` (mm) from
 * the bone is one of a part that is not there. Throws std::invalid_argument where medial and lateral are interchanged,
 * which the head shows.
 *
 * \param surface  closed, mm. */
FemurGeometry
FitFemur(const TriangleSurface & surface, const std::vector<Landmark> & landmarks, double farthest = 20.0);

/** \brief The measures of a fitted femur, with their definitions; those that lack a primitive say so.
 *
 * headCentre, headRadius, headDeviation; neckShaftAngle; femoralOffset; neckHeight, neckDepth, neckSectionArea;
 * anteversion; side (right or left).
 *
 * Sources: anteversion S. B. Murphy et al., doi:10.2106/00004623-198769080-00011; neck-shaft angle C. K. Boese et al.,
 * doi:10.1007/s00256-015-2236-z; offset P. C. Noble et al., Clin Orthop Relat Res 235:148-165, 1988. */
MeasureList
MeasureFemur(const FemurGeometry & femur);

/** \brief Thickness of the cortex along the neck: on seven cross-sections at right angles to the neck's axis, evenly
 * from 5 mm on the head's side of the narrowest one to 10 mm on the shaft's side.
 *
 * neckCorticalThickness: mean over the narrowest section; neckCorticalThicknessProfile: mean over each section, with
 * neckCorticalThicknessPlaces, the sections' places from the head's centre. The thickness at a point of the outline is
 * its distance to the endosteal surface, the boundary of all regions but the cortical one (region 1).
 *
 * \param mesh  of the femur, with regions and neighbours. */
MeasureList
MeasureNeckCortex(const MeshArrays & mesh, const FemurGeometry & femur);
} // namespace bone

#endif
