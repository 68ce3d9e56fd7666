/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRadiographPreprocess.h"

#include "boneCollimator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
/** Photons below this share of the open beam's are as good as none. */
constexpr double LeastShare = 1e-4;
/** A value that so large a share of the field has is an end of the display's range. */
constexpr double PlateauShare = 0.005;
/** Changes of brightness that are no collimator's: of the logarithm of photons, of the display's range. */
constexpr double LeastLogContrast = 0.7;
constexpr double LeastDisplayContrast = 0.2;

using Bytes = std::vector<std::uint8_t>;

[[noreturn]] void
RefuseRadiograph(const std::string & reason)
{
  throw std::invalid_argument(reason);
}

double
QuantileOf(std::vector<double> & values, double share)
{
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/** The values where `where` is set. */
std::vector<double>
Chosen(const std::vector<double> & values, const Bytes & where)
{
  std::vector<double> chosen;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (where[i] != 0)
    {
      chosen.push_back(values[i]);
    }
  }
  return chosen;
}

/** Visits the pixels of the 5 x 5 square around a pixel that lie in the image, without itself. */
template <typename TVisit>
void
ForNeighbours(const std::array<int, 2> & size, std::size_t pixel, int reach, TVisit && visit)
{
  const int column = static_cast<int>(pixel % size[0]), row = static_cast<int>(pixel / size[0]);
  for (int r = std::max(0, row - reach); r <= std::min(size[1] - 1, row + reach); ++r)
  {
    for (int c = std::max(0, column - reach); c <= std::min(size[0] - 1, column + reach); ++c)
    {
      if (c != column || r != row)
      {
        visit(static_cast<std::size_t>(r) * size[0] + c);
      }
    }
  }
}

/** Whether a pixel stands out from its surroundings alone, or with one other. */
bool
IsDead(const std::vector<double> & pixels,
       const Bytes &               finite,
       const std::array<int, 2> &  size,
       std::size_t                 i,
       double                      k)
{
  // Of two dead neighbours one is between the other and the rest.
  int below = 0, above = 0;
  ForNeighbours(size, i, 1, [&](std::size_t j) {
    below += finite[j] != 0 && pixels[j] <= pixels[i] ? 1 : 0;
    above += finite[j] != 0 && pixels[j] >= pixels[i] ? 1 : 0;
  });
  if (below > 1 && above > 1)
  {
    return false;
  }
  std::vector<double> near;
  near.reserve(24);
  ForNeighbours(size, i, 2, [&](std::size_t j) {
    if (finite[j] != 0)
    {
      near.push_back(pixels[j]);
    }
  });
  if (near.size() < 8)
  {
    return false;
  }
  std::vector<double> sorted = near;
  const double        median = QuantileOf(sorted, 0.5);
  std::transform(sorted.begin(), sorted.end(), sorted.begin(), [median](double v) { return std::abs(v - median); });
  const double deviation = 1.4826 * QuantileOf(sorted, 0.5);
  const double jump = pixels[i] - median;
  if (!(std::abs(jump) > std::max(k * deviation, 0.1 * std::abs(median))))
  {
    return false;
  }
  const auto alike = std::count_if(near.begin(), near.end(), [&](double v) { return (v - median) / jump > 0.5; });
  return alike <= 1;
}

/** Gives each marked pixel the median of those around it that are not marked. */
void
Repair(const Bytes & marked, const std::array<int, 2> & size, std::vector<double> & pixels)
{
  const std::vector<double> before = pixels;
  for (std::size_t i = 0; i < pixels.size(); ++i)
  {
    if (marked[i] == 0)
    {
      continue;
    }
    std::vector<double> near;
    for (int reach = 2; near.empty() && reach <= 8; reach *= 2)
    {
      ForNeighbours(size, i, reach, [&](std::size_t j) {
        if (marked[j] == 0)
        {
          near.push_back(before[j]);
        }
      });
    }
    pixels[i] = near.empty() ? 0.0 : QuantileOf(near, 0.5);
  }
}

/** Means of 5 x 5 pixels. */
std::vector<double>
Smoothed(const std::vector<double> & pixels, const std::array<int, 2> & size, const Execution & execution)
{
  std::vector<double> means(pixels.size());
  execution.For(
    pixels.size(),
    [&](std::size_t i) {
      double sum = pixels[i];
      int    count = 1;
      ForNeighbours(size, i, 2, [&](std::size_t j) {
        sum += pixels[j];
        ++count;
      });
      means[i] = sum / count;
    },
    4096);
  return means;
}

class Preprocessing
{
public:
  Preprocessing(std::vector<double> &&                 pixels,
                const Bytes &                          mask,
                const DetectorGrid &                   grid,
                const RadiographPreprocessParameters & parameters,
                const Execution &                      execution)
    : m_Pixels(std::move(pixels))
    , m_Mask(mask)
    , m_Grid(grid)
    , m_Parameters(parameters)
    , m_Execution(execution)
    , m_Field(m_Pixels.size(), 1)
    , m_Bad(m_Pixels.size(), 0)
  {}

  PreprocessedRadiograph
  Run()
  {
    m_Result.report.monotoneOnly = m_Parameters.values == RadiographValues::Display;
    this->MarkNotFinite();
    this->ApplyCrop();
    if (m_Parameters.values != RadiographValues::Integral)
    {
      this->FindDeadPixels();
      m_Execution.Report(0.3);
    }
    Repair(m_Bad, m_Grid.size, m_Pixels);
    if (m_Parameters.values != RadiographValues::Integral && m_Parameters.detectCollimator)
    {
      this->ApplyCollimator();
    }
    m_Execution.Report(0.5);
    m_Weights.assign(m_Pixels.size(), 1.0);
    switch (m_Parameters.values)
    {
      case RadiographValues::Integral:
        this->FromIntegrals();
        break;
      case RadiographValues::Intensity:
        this->FromIntensities();
        break;
      case RadiographValues::Display:
        this->FromDisplay();
        break;
    }
    this->Finish();
    m_Execution.Report(1.0);
    return std::move(m_Result);
  }

private:
  void
  MarkNotFinite()
  {
    for (std::size_t i = 0; i < m_Pixels.size(); ++i)
    {
      if (!std::isfinite(m_Pixels[i]))
      {
        m_Bad[i] = 1;
        ++m_Result.report.notFinite;
      }
    }
    if (m_Result.report.notFinite == m_Pixels.size())
    {
      RefuseRadiograph("No pixel of the input is finite: all are NaN or infinite.");
    }
  }

  void
  ApplyCrop()
  {
    const auto & crop = m_Parameters.crop;
    if (crop.empty())
    {
      return;
    }
    const auto & size = m_Grid.size;
    bool         good = crop.size() == 4;
    for (std::size_t k = 0; k < 2 && good; ++k)
    {
      good = crop[2 + k] > 0 && crop[k] <= size[k] - crop[2 + k];
    }
    if (!good)
    {
      RefuseRadiograph("Crop is " + ParameterText(crop) +
                       ", but must be first column, first row, columns and rows within the " + std::to_string(size[0]) +
                       " x " + std::to_string(size[1]) + " pixels of the input.");
    }
    this->Keep(
      [&](int c, int r) { return c >= crop[0] && c < crop[0] + crop[2] && r >= crop[1] && r < crop[1] + crop[3]; });
  }

  /** Takes all other pixels out of the field. */
  template <typename TKeep>
  void
  Keep(TKeep && keep)
  {
    for (int r = 0; r < m_Grid.size[1]; ++r)
    {
      for (int c = 0; c < m_Grid.size[0]; ++c)
      {
        if (!keep(c, r))
        {
          m_Field[static_cast<std::size_t>(r) * m_Grid.size[0] + c] = 0;
        }
      }
    }
  }

  void
  FindDeadPixels()
  {
    if (!(m_Parameters.deadPixelThreshold > 0))
    {
      return;
    }
    Bytes finite(m_Bad.size()), dead(m_Bad.size(), 0);
    std::transform(m_Bad.begin(), m_Bad.end(), finite.begin(), [](std::uint8_t bad) { return bad == 0 ? 1 : 0; });
    m_Execution.Silent().For(
      m_Pixels.size(),
      [&](std::size_t i) {
        dead[i] = finite[i] != 0 && IsDead(m_Pixels, finite, m_Grid.size, i, m_Parameters.deadPixelThreshold) ? 1 : 0;
      },
      4096);
    for (std::size_t i = 0; i < dead.size(); ++i)
    {
      m_Bad[i] = m_Bad[i] != 0 || dead[i] != 0 ? 1 : 0;
      m_Result.report.deadPixels += dead[i];
    }
  }

  void
  ApplyCollimator()
  {
    auto & edges = m_Result.report.collimator;
    if (m_Parameters.values == RadiographValues::Display)
    {
      edges = FindCollimator(this->DisplayExposure(), m_Grid.size, LeastDisplayContrast);
    }
    else
    {
      std::vector<double> exposure = m_Pixels;
      const double        high = QuantileOf(exposure, 0.995);
      if (!(high > 0))
      {
        return;
      }
      std::transform(m_Pixels.begin(), m_Pixels.end(), exposure.begin(), [high](double v) {
        return std::log(std::max(v / high, 1e-3));
      });
      edges = FindCollimator(exposure, m_Grid.size, LeastLogContrast);
    }
    const double margin = 0.01 * m_Parameters.collimatorMargin * std::max(m_Grid.size[0], m_Grid.size[1]);
    this->Keep([&](int c, int r) {
      return std::all_of(edges.begin(), edges.end(), [&](const CollimatorEdge & edge) {
        return edge.normal.dot(Vector2(c, r)) <= edge.offset - margin;
      });
    });
  }

  /** Display values from 0 to 1 between the 0.5 and 99.5 % quantiles of the field, larger where there are more photons.
   */
  std::vector<double>
  DisplayExposure() const
  {
    auto         field = Chosen(m_Pixels, m_Field);
    const double low = field.empty() ? 0.0 : QuantileOf(field, 0.005);
    const double high = field.empty() ? 0.0 : QuantileOf(field, 0.995);
    if (!(high > low))
    {
      RefuseRadiograph("The input is constant: it shows nothing.");
    }
    std::vector<double> exposure(m_Pixels.size());
    std::transform(m_Pixels.begin(), m_Pixels.end(), exposure.begin(), [&](double v) {
      return m_Parameters.largerAttenuates ? (high - v) / (high - low) : (v - low) / (high - low);
    });
    return exposure;
  }

  void
  FromIntegrals()
  {
    m_Result.report.openBeam = 1.0;
    m_Integrals = m_Pixels;
    if (!(m_Parameters.scatterToPrimary > 0) && !m_Parameters.quantumWeights)
    {
      return;
    }
    std::transform(m_Pixels.begin(), m_Pixels.end(), m_Pixels.begin(), [](double v) { return std::exp(-v); });
    this->FromPhotons(1.0);
  }

  void
  FromIntensities()
  {
    auto & report = m_Result.report;
    report.openBeamEstimated = !(m_Parameters.openBeam > 0);
    const auto smooth = Smoothed(m_Pixels, m_Grid.size, m_Execution.Silent());
    const auto field = Chosen(smooth, m_Field);
    report.openBeam = report.openBeamEstimated ? EstimateOpenBeam(field) : m_Parameters.openBeam;
    const double open = report.openBeam;
    const auto   air = std::count_if(field.begin(), field.end(), [open](double v) { return v >= 0.95 * open; });
    report.airShare = field.empty() ? 0.0 : static_cast<double>(air) / static_cast<double>(field.size());
    for (std::size_t i = 0; i < m_Pixels.size(); ++i)
    {
      const bool none = !(m_Pixels[i] > 0), full = m_Pixels[i] >= open;
      m_Weights[i] = none ? 0.0 : full ? m_Parameters.airWeight : 1.0;
      report.saturated += none || full ? 1 : 0;
      m_Pixels[i] = std::max(m_Pixels[i], LeastShare * open);
    }
    this->FromPhotons(open);
  }

  /** The middle of the brightest pixels, those within 10 % of the 99.5 % quantile. */
  static double
  EstimateOpenBeam(std::vector<double> field)
  {
    const double high = field.empty() ? 0.0 : QuantileOf(field, 0.995);
    if (!(high > 0))
    {
      RefuseRadiograph("No pixel of the exposed field is above 0, so I0 cannot be estimated: check the pixels' kind.");
    }
    field.erase(std::remove_if(field.begin(), field.end(), [high](double v) { return v < 0.9 * high; }), field.end());
    return QuantileOf(field, 0.5);
  }

  /** Line integrals of photons, after subtraction of scatter. */
  void
  FromPhotons(double open)
  {
    const ScatterModel model{ m_Parameters.scatterToPrimary, m_Parameters.scatterWidth, open };
    auto               solution = SubtractScatter(m_Pixels, m_Grid, model, m_Parameters.leastPrimary, m_Execution);
    m_Result.report.scatterIterations = solution.iterations;
    m_Integrals.resize(m_Pixels.size());
    for (std::size_t i = 0; i < m_Pixels.size(); ++i)
    {
      const double primary = std::max(solution.primary[i], m_Parameters.leastPrimary * LeastShare * open);
      m_Integrals[i] = -std::log(primary / open);
      if (m_Parameters.quantumWeights)
      {
        m_Weights[i] *= std::min(1.0, primary * primary / (m_Pixels[i] * open));
      }
    }
    m_Ratio = std::move(solution.primary);
    for (std::size_t i = 0; i < m_Pixels.size(); ++i)
    {
      m_Ratio[i] = m_Ratio[i] > 0 ? m_Pixels[i] / m_Ratio[i] - 1 : 0.0;
    }
  }

  void
  FromDisplay()
  {
    if (m_Parameters.scatterToPrimary > 0)
    {
      RefuseRadiograph("Scatter cannot be subtracted from display values, whose photons are not known: set "
                       "ScatterToPrimary to 0.");
    }
    this->WeighPlateaus();
    m_Integrals = this->DisplayExposure();
    const bool linear = m_Parameters.displayCurve == DisplayCurve::Linear;
    std::transform(m_Integrals.begin(), m_Integrals.end(), m_Integrals.begin(), [linear](double exposure) {
      return linear ? 1 - exposure : -std::log(std::max(exposure, 1e-3));
    });
  }

  /** Many pixels at the smallest or the largest value are at an end of the display's range. */
  void
  WeighPlateaus()
  {
    const auto field = Chosen(m_Pixels, m_Field);
    const auto ends = std::minmax_element(field.begin(), field.end());
    if (field.empty() || *ends.first == *ends.second)
    {
      RefuseRadiograph("The input is constant: it shows nothing.");
    }
    for (const bool largest : { false, true })
    {
      const double end = largest ? *ends.second : *ends.first;
      const auto   there = std::count(field.begin(), field.end(), end);
      if (static_cast<double>(there) < PlateauShare * static_cast<double>(field.size()))
      {
        continue;
      }
      const double weight = largest == m_Parameters.largerAttenuates ? 0.0 : m_Parameters.airWeight;
      for (std::size_t i = 0; i < m_Pixels.size(); ++i)
      {
        if (m_Pixels[i] == end)
        {
          m_Weights[i] = weight;
          ++m_Result.report.saturated;
        }
      }
    }
  }

  void
  Finish()
  {
    const std::size_t   count = m_Pixels.size();
    std::vector<double> used, ratio;
    m_Result.integrals.resize(count);
    m_Result.weights.resize(count);
    for (std::size_t i = 0; i < count; ++i)
    {
      const bool keep = m_Field[i] != 0 && m_Bad[i] == 0 && (m_Mask.empty() || m_Mask[i] != 0);
      m_Result.integrals[i] = static_cast<float>(m_Integrals[i]);
      m_Result.weights[i] = keep ? static_cast<float>(m_Weights[i]) : 0.0f;
      if (m_Result.weights[i] > 0)
      {
        used.push_back(m_Integrals[i]);
        if (!m_Ratio.empty())
        {
          ratio.push_back(m_Ratio[i]);
        }
      }
    }
    if (used.empty())
    {
      RefuseRadiograph("No pixel of the input can be used: " + this->WhyNone());
    }
    const auto ends = std::minmax_element(used.begin(), used.end());
    if (!(*ends.second > *ends.first))
    {
      RefuseRadiograph("All pixels of the input that can be used are the same: it shows nothing.");
    }
    m_Result.report.usedShare = static_cast<double>(used.size()) / static_cast<double>(count);
    m_Result.report.scatterToPrimary =
      m_Parameters.scatterToPrimary > 0 && !ratio.empty() ? QuantileOf(ratio, 0.5) : 0.0;
  }

  std::string
  WhyNone() const
  {
    if (!m_Mask.empty() && std::all_of(m_Mask.begin(), m_Mask.end(), [](std::uint8_t m) { return m == 0; }))
    {
      return "the mask is 0 everywhere.";
    }
    if (std::all_of(m_Field.begin(), m_Field.end(), [](std::uint8_t f) { return f == 0; }))
    {
      return "all lie beyond the collimator's borders or the crop.";
    }
    if (m_Result.report.saturated > 0)
    {
      return "all within mask, crop and exposed field are saturated, at zero, or at or above I0: check I0 and the "
             "pixels' kind, or set AirWeight.";
    }
    return "mask, crop and exposed field have no pixel in common.";
  }

  std::vector<double>                    m_Pixels;
  const Bytes &                          m_Mask;
  const DetectorGrid &                   m_Grid;
  const RadiographPreprocessParameters & m_Parameters;
  const Execution &                      m_Execution;
  Bytes                                  m_Field; ///< within crop and collimator
  Bytes                                  m_Bad;   ///< dead or not finite
  std::vector<double>                    m_Weights;
  std::vector<double>                    m_Integrals;
  std::vector<double>                    m_Ratio; ///< scatter to primary
  PreprocessedRadiograph                 m_Result;
};
} // namespace

PreprocessedRadiograph
PreprocessRadiograph(std::vector<double>                    pixels,
                     const std::vector<std::uint8_t> &      mask,
                     const DetectorGrid &                   grid,
                     const RadiographPreprocessParameters & parameters,
                     const Execution &                      execution)
{
  parameters.Verify();
  return Preprocessing(std::move(pixels), mask, grid, parameters, execution).Run();
}
} // namespace bone
