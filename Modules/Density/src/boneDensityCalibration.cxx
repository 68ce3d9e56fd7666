/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityCalibration.h"

#include "boneBernstein.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
using Quantity = DensityQuantity;
} // namespace

const std::vector<DensityLaw> &
PublishedDensityLaws()
{
  // Slopes take mg/cm^3 to g/cm^3.
  static const std::vector<DensityLaw> laws = {
    { "les1994",
      Quantity::K2HPO4MilligramPerCubicCentimetre,
      Quantity::AshGramPerCubicCentimetre,
      1.22e-3,
      0.0526,
      0.0,
      1200.0,
      "Les et al., J Orthop Res 12:822-833, 1994" },
    { "keyak2005",
      Quantity::HydroxyapatiteMilligramPerCubicCentimetre,
      Quantity::AshGramPerCubicCentimetre,
      0.887e-3,
      0.0633,
      0.0,
      1500.0,
      "Keyak et al., Clin Orthop Relat Res 437:219-228, 2005" },
    { "schileo2008",
      Quantity::AshGramPerCubicCentimetre,
      Quantity::ApparentGramPerCubicCentimetre,
      1 / 0.598,
      0.0,
      0.0,
      1.3,
      "Schileo et al., J Biomech 41:2483-2491, 2008" },
  };
  return laws;
}

const DensityLaw &
FindDensityLaw(const std::string & name)
{
  std::string list;
  for (const DensityLaw & law : PublishedDensityLaws())
  {
    if (law.name == name)
    {
      return law;
    }
    list += (list.empty() ? "" : ", ") + law.name;
  }
  throw std::invalid_argument("There is no density law '" + name + "'; there are " + list + ".");
}

void
RequireDensityQuantity(DensityQuantity actual, DensityQuantity expected, const std::string & what)
{
  if (actual != expected)
  {
    throw std::invalid_argument("The density of " + what + " is in " + DensityQuantityName(actual) +
                                ", but must be in " + DensityQuantityName(expected) + ".");
  }
}

Calibration
CalibrateDensity(const std::vector<CalibrationReference> & references, DensityQuantity to)
{
  const auto count = static_cast<double>(references.size());
  double     meanValue = 0, meanDensity = 0;
  for (const CalibrationReference & r : references)
  {
    if (!(std::isfinite(r.value) && std::isfinite(r.density)))
    {
      throw std::invalid_argument("Reference '" + r.name + "' has a value or density that is not finite.");
    }
    meanValue += r.value / count;
    meanDensity += r.density / count;
  }
  double values = 0, densities = 0, products = 0;
  for (const CalibrationReference & r : references)
  {
    values += (r.value - meanValue) * (r.value - meanValue);
    densities += (r.density - meanDensity) * (r.density - meanDensity);
    products += (r.value - meanValue) * (r.density - meanDensity);
  }
  if (!(values > 0))
  {
    throw std::invalid_argument("A calibration needs references of at least two different values.");
  }
  if (!(products > 0))
  {
    throw std::invalid_argument("The density of the references does not rise with their value: check which is which.");
  }
  Calibration  calibration;
  DensityLaw & law = calibration.law;
  law.name = "calibration";
  law.to = to;
  law.slope = products / values;
  law.intercept = meanDensity - law.slope * meanValue;
  law.low = law.high = references.front().value;
  calibration.correlation = products / std::sqrt(values * densities);
  for (const CalibrationReference & r : references)
  {
    law.low = std::min(law.low, r.value);
    law.high = std::max(law.high, r.value);
    calibration.residuals.push_back(law(r.value) - r.density);
    calibration.rms += calibration.residuals.back() * calibration.residuals.back() / count;
  }
  calibration.rms = std::sqrt(calibration.rms);
  return calibration;
}

double
ConvertDensity(MeshArrays & mesh, const DensityLaw & law)
{
  if (!mesh.HasDensity())
  {
    throw std::invalid_argument("The mesh holds no density: fit one first.");
  }
  RequireDensityQuantity(mesh.quantity, law.from, "the mesh");
  const std::size_t row = BernsteinCount(mesh.maximumDegree);
  double            outside = 0, total = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 &  v = mesh.tetrahedra[t];
    const double volume = SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]);
    double *     c = &mesh.coefficients[t * row];
    const double mean = BernsteinIntegral(mesh.degree[t], c, 1.0);
    total += volume;
    outside += mean < law.low || mean > law.high ? volume : 0.0;
    std::transform(c, c + BernsteinCount(mesh.degree[t]), c, law);
  }
  mesh.quantity = law.to;
  return total > 0 ? outside / total : 0.0;
}
} // namespace bone
