/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityCalibration_h
#define boneDensityCalibration_h

#include "boneMeshArrays.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup DensityCalibration What density values mean
 *
 * A CT's Hounsfield units become an equivalent mineral density (mg/cm^3 of K2HPO4 or hydroxyapatite) by a line that is
 * fitted to materials of known density in the same scan: the rods of a phantom, or tissues of the patient. From there a
 * published law leads to ash density, and another to apparent density (g/cm^3). All are lines, which take a Bernstein
 * polynomial to one of the same degree, exactly. Every density mesh carries its quantity, and a law applied to another
 * than its own is refused.
 * \{ */

/** density = intercept + slope * value */
struct DensityLaw
{
  std::string     name;
  DensityQuantity from{ DensityQuantity::HounsfieldUnit };
  DensityQuantity to{ DensityQuantity::Unknown };
  double          slope{ 1.0 };
  double          intercept{ 0.0 };
  double          low{ 0.0 }; ///< range of values that the law is meant for, in units of `from`
  double          high{ 0.0 };
  std::string     source;

  double
  operator()(double value) const
  {
    return intercept + slope * value;
  }
};

/** The published laws:
 * - les1994: ash = 0.0526 + 1.22 K2HPO4 (g/cm^3); C. M. Les et al., J Orthop Res 12:822-833, 1994, used for human
 * femora by Keyak et al.
 * - keyak2005: ash = 0.0633 + 0.887 HA (g/cm^3); J. H. Keyak et al., Clin Orthop Relat Res 437:219-228, 2005.
 * - schileo2008: apparent = ash / 0.598; E. Schileo et al., J Biomech 41:2483-2491, 2008,
 *   doi:10.1016/j.jbiomech.2008.05.017: one ratio from trabecular to cortical bone.
 *
 * Their ranges are what bone holds, from marrow without mineral to the densest cortical bone. */
const std::vector<DensityLaw> &
PublishedDensityLaws();

/** The published law of that name; std::invalid_argument, which lists the names, where there is none. */
const DensityLaw &
FindDensityLaw(const std::string & name);

/** Throws std::invalid_argument, which names both, where the quantities differ. `what`: what carries `actual`. */
void
RequireDensityQuantity(DensityQuantity actual, DensityQuantity expected, const std::string & what);

/** A material of known density in a CT. */
struct CalibrationReference
{
  std::string name;
  double      value{ 0.0 };   ///< measured in the CT, HU
  double      density{ 0.0 }; ///< known, in the unit of the calibration
};

/** A line through references, and how well they lie on it. */
struct Calibration
{
  DensityLaw          law;
  std::vector<double> residuals; ///< of each reference: density by the law less the known one
  double              rms{ 0.0 };
  double              correlation{ 1.0 };
};

/** The least-squares line of density on value. Its range is that of the references' values. Throws
 * std::invalid_argument where there are fewer than two values, they are not finite, or density does not rise with
 * value.
 */
Calibration
CalibrateDensity(const std::vector<CalibrationReference> & references, DensityQuantity to);

/** Applies a law to a mesh's density and changes its quantity. Returns the share of the volume whose mean density (in
 * each tetrahedron) lay outside the law's range. Throws std::invalid_argument where the mesh has no density or another
 * quantity than the law's. */
double
ConvertDensity(MeshArrays & mesh, const DensityLaw & law);
/** \} */
} // namespace bone

#endif
