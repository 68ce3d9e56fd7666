/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTypes_h
#define boneTypes_h

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <string>

namespace bone
{
/** Coordinates in millimetres, ITK physical space (LPS). */
using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;

/** Index of a point or a tetrahedron; -1 is "none". */
using IdType = std::int32_t;

/** Four ids: the vertices of a tetrahedron, or its face neighbours. */
using Id4 = std::array<IdType, 4>;

/** Vertices of the face opposite vertex i, in the order that looks outward when the tetrahedron's volume is positive.
 */
constexpr std::array<std::array<int, 3>, 4> TetraFaces = { { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } } };

/** The six edges of a tetrahedron; edge e and edge 5 - e are opposite. */
constexpr std::array<std::array<int, 2>, 6> TetraEdges = {
  { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } }
};

/** Regions of a bone, counted inward from the surface. Layers deeper than the medullary cavity count on. */
enum Region : int
{
  Outside = 0,
  Cortical = 1,
  Trabecular = 2,
  Medullary = 3
};

/** What a density value means; the numbers are those of the files. */
enum class DensityQuantity : int
{
  Unknown = 0,
  HounsfieldUnit = 1,
  K2HPO4MilligramPerCubicCentimetre = 2,
  HydroxyapatiteMilligramPerCubicCentimetre = 3,
  AshGramPerCubicCentimetre = 4,
  ApparentGramPerCubicCentimetre = 5
};

/** A short name with the unit, for reports ("HU", "K2HPO4 mg/cm3", ...). */
std::string
DensityQuantityName(DensityQuantity quantity);
} // namespace bone

#endif
