/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeasureReport_h
#define boneMeasureReport_h

#include "boneCutIntegrals.h"
#include "boneLandmarkTransfer.h"
#include "boneMeasure.h"
#include "boneMeasureParameters.h"
#include "boneTriangleSurface.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace bone
{
/** A solid with the name that its measures begin with: "ball1". */
struct NamedSolid
{
  std::string name;
  std::string description; ///< "the ball of radius 10 mm about (1, 2, 3)"
  Solid       solid;
};

/** What a solid is given by, mm. */
enum class SolidShape : int
{
  Ball = 0,     ///< x y z radius
  Cylinder = 1, ///< x y z of one end, x y z of the other, radius
  Capsule = 2,  ///< the same with round ends beyond
  HalfSpace = 3 ///< x y z of a point of its plane, x y z into it
};

/** How many numbers a solid is given by. */
std::size_t
NumbersOfSolid(SolidShape shape);

/** Solids of one shape, so many numbers each, with names ("ball1", "ball2", ...) and descriptions. Throws
 * std::invalid_argument where numbers make no solid, see MakeBall. */
std::vector<NamedSolid>
NameSolids(SolidShape shape, const std::vector<double> & numbers);

/** Everything measured on a model. */
struct MeasureReport
{
  std::vector<Landmark>      landmarks; ///< as given, or as carried
  std::vector<LandmarkPlace> places;    ///< in the model, one for each landmark; none where the model is a surface
  MeasureList                list;
};

/** \brief Unit of a mass, and what the integral of the density over mm^3 is multiplied with to be in it: mg for
 * densities in mg/cm^3 and g/cm^3, else the density's unit times mm^3. */
std::string
MassUnit(DensityQuantity quantity, double & factor);

/** \brief Volume, mass and mean density of what a solid holds of a model, in all and by region: NAME.volume, NAME.mass,
 * NAME.meanDensity, NAME.region1.volume, .... */
MeasureList
MeasurePart(const MeshArrays & mesh, const NamedSolid & part, const MeasureParameters & parameters);

/** \brief Everything that can be measured on a model: its regions, `solids`, and with the landmarks of a femur or a
 * hemipelvis (see FitFemur, FitHemipelvis) that bone's measures.
 *
 * Landmarks are in the model's space; those that no measure needs are placed in the model all the same. Throws
 * std::invalid_argument as FitFemur and FitHemipelvis. */
MeasureReport
MeasureModel(const MeshArrays &              mesh,
             const std::vector<Landmark> &   landmarks,
             const std::vector<NamedSolid> & solids = {},
             const MeasureParameters &       parameters = MeasureParameters());

/** \brief What can be measured on a closed surface alone: no density, no cortex. */
MeasureReport
MeasureSurface(const TriangleSurface &       surface,
               const std::vector<Landmark> & landmarks,
               const MeasureParameters &     parameters = MeasureParameters());

/** \brief As JSON: `landmarks` and `measures`, each with `name`, `value`, `unit` and `definition`, and `missing`, each
 * with `name` and `reason`. A landmark also has `distance` (mm, to the model), `cell` and `barycentric`; a measure
 * whose error is more than rounding has `errorBound`. */
nlohmann::json
ReportMeasures(const MeasureReport & report);
} // namespace bone

#endif
