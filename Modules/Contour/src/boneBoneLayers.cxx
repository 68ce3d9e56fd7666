/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBoneLayers.h"

#include "boneSnake.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

namespace bone
{
namespace
{
// A point of a periosteal contour and the thickness of the cortex under it.
struct SurfaceSample
{
  Vector2 position;
  Vector2 inward;
  double  thickness;
};
using SliceSamples = std::vector<std::vector<SurfaceSample>>; // by piece

class LayerFinder
{
public:
  LayerFinder(const PlaneSource & planes, const Vector2 & pixel, const LayerParameters & parameters)
    : m_Planes(planes)
    , m_Parameters(parameters)
    , m_Pixel(pixel.maxCoeff())
  {
    for (int a = 0; a < 2; ++a)
    {
      m_Spacing[a] = pixel[a] / std::ceil(pixel[a] / 0.8);
    }
  }

  SliceSamples
  MeasureThickness(const BoneSection & section) const;

  std::vector<Polygon>
  FindEndosteal(const BonePiece & piece, const std::vector<SurfaceSample> & samples) const;

  std::vector<Polygon>
  FindMedullary(const BonePiece & piece, const PlaneField & plane) const;

  PlaneField
  PlaneOf(const BoneSection & section) const
  {
    std::vector<Polygon> outer;
    for (const BonePiece & piece : section.pieces)
    {
      outer.push_back(piece.outer);
    }
    const PlaneGrid box = CoveringGrid(outer, 4.0 * m_Pixel, Vector2::Zero(), m_Spacing);
    return m_Planes(section.height, box.origin, box.Node(box.size[0] - 1, box.size[1] - 1));
  }

private:
  PlaneGrid
  GridAround(const Polygon & polygon, double margin) const
  {
    return CoveringGrid({ polygon }, margin, polygon.front(), m_Spacing);
  }

  double
  CorticalDepth(const std::vector<double> & profile, double step) const;

  std::vector<Polygon>
  Regularise(PlaneField & field, const PlaneField & allowed) const;

  const PlaneSource &     m_Planes;
  const LayerParameters & m_Parameters;
  double                  m_Pixel;
  Vector2                 m_Spacing;
};

SliceSamples
LayerFinder::MeasureThickness(const BoneSection & section) const
{
  SliceSamples result(section.pieces.size());
  if (section.pieces.empty())
  {
    return result;
  }
  const PlaneField plane = this->PlaneOf(section);
  const double     step = 0.25 * m_Spacing.minCoeff();
  for (std::size_t p = 0; p < section.pieces.size(); ++p)
  {
    const BonePiece & piece = section.pieces[p];
    if (!piece.holes.empty())
    {
      continue;
    }
    const Polygon       outline = ResampleUniform(piece.outer, 1.0);
    const std::size_t   n = outline.size();
    const DistanceField depth =
      ComputeDistanceField({ outline }, this->GridAround(outline, m_Pixel), m_Parameters.maximumThickness + m_Pixel);
    std::vector<std::vector<double>> profiles(n);
    for (std::size_t i = 0; i < n; ++i)
    {
      const Vector2 tangent = (outline[(i + 2) % n] - outline[(i + n - 2) % n]).normalized();
      const Vector2 inward(-tangent.y(), tangent.x());
      result[p].push_back({ outline[i], inward, 0.0 });
      for (double d = 0.0; d <= m_Parameters.maximumThickness; d += step)
      {
        const Vector2 q = outline[i] + d * inward;
        if (depth.distance.Sample(q) < d - 0.75 * m_Pixel)
        {
          break;
        }
        profiles[i].push_back(plane.Sample(q));
      }
    }
    std::vector<double> mean;
    for (std::size_t i = 0; i < n; ++i)
    {
      const auto & before = profiles[(i + n - 1) % n];
      const auto & here = profiles[i];
      const auto & after = profiles[(i + 1) % n];
      mean = here;
      for (std::size_t k = 0; k < std::min({ before.size(), here.size(), after.size() }); ++k)
      {
        mean[k] = 0.25 * (before[k] + 2.0 * here[k] + after[k]);
      }
      result[p][i].thickness = this->CorticalDepth(mean, step);
    }
  }
  return result;
}

double
LayerFinder::CorticalDepth(const std::vector<double> & profile, double step) const
{
  const double least = m_Parameters.minimumDistance;
  const auto   window = std::min(profile.size(), static_cast<std::size_t>(std::max(3.0, 3.0 * m_Pixel) / step) + 1);
  if (window < 2)
  {
    return least;
  }
  const auto   peak = std::max_element(profile.begin(), profile.begin() + static_cast<std::ptrdiff_t>(window));
  const double solid = static_cast<double>(profile.size()) * step + m_Pixel;
  double       threshold = m_Parameters.endostealThreshold;
  if (!(threshold > 0.0))
  {
    std::vector<double> rest(peak, profile.end());
    const auto          low = rest.begin() + static_cast<std::ptrdiff_t>(rest.size() / 5);
    std::nth_element(rest.begin(), low, rest.end());
    if (*peak - *low < m_Parameters.minimumContrast)
    {
      return *low > m_Parameters.solidLevel ? solid : least;
    }
    threshold = 0.5 * (*peak + *low);
  }
  if (*peak < threshold)
  {
    return least;
  }
  for (auto at = peak; at + 1 != profile.end(); ++at)
  {
    if (*(at + 1) < threshold)
    {
      const double fraction = (*at - threshold) / (*at - *(at + 1));
      return std::max(least, (static_cast<double>(at - profile.begin()) + fraction) * step);
    }
  }
  return solid;
}

// Closes and opens the region where `field` is positive with a disk, within the region where `allowed` is positive, and
// returns the parts that are large enough to be of use.
std::vector<Polygon>
LayerFinder::Regularise(PlaneField & field, const PlaneField & allowed) const
{
  const double      radius = m_Parameters.smallestRadius;
  const double      limit = radius + 2.0 * m_Spacing.maxCoeff();
  const PlaneGrid & grid = field.grid;
  const auto        outlines = [](const PlaneField & f, double level) {
    std::vector<Polygon> loops = ExtractLevelContours(f, level);
    loops.erase(
      std::remove_if(loops.begin(), loops.end(), [](const Polygon & loop) { return SignedArea(loop) <= 0.0; }),
      loops.end());
    return loops;
  };
  auto loops = outlines(field, 0.0);
  loops = outlines(ComputeDistanceField(loops, grid, limit).distance, -radius);
  field = ComputeDistanceField(loops, grid, limit).distance;
  for (std::size_t n = 0; n < field.values.size(); ++n)
  {
    field.values[n] = std::min(field.values[n] - static_cast<float>(radius), allowed.values[n]);
  }
  loops = outlines(field, 0.0);
  const auto cores = outlines(ComputeDistanceField(loops, grid, limit).distance, radius);

  std::vector<Polygon> result;
  for (const Polygon & core : cores)
  {
    for (Polygon & loop : outlines(ComputeDistanceField({ core }, grid, limit).distance, -radius))
    {
      if (SignedArea(loop) >= 0.4 * m_Parameters.smallestArea)
      {
        result.push_back(std::move(loop));
      }
    }
  }
  return result;
}

std::vector<Polygon>
LayerFinder::FindEndosteal(const BonePiece & piece, const std::vector<SurfaceSample> & samples) const
{
  if (samples.empty())
  {
    return {};
  }
  Polygon outline;
  for (const SurfaceSample & sample : samples)
  {
    outline.push_back(sample.position);
  }
  const double        margin = m_Parameters.smallestRadius + 3.0 * m_Spacing.maxCoeff();
  const DistanceField depth =
    ComputeDistanceField({ outline }, this->GridAround(piece.outer, margin), m_Parameters.maximumThickness + 3.0);
  PlaneField allowed = depth.distance;
  PlaneField field = depth.distance;
  for (std::size_t n = 0; n < field.values.size(); ++n)
  {
    double thickness = 0.0;
    if (depth.edge[n] >= 0)
    {
      const auto   e = static_cast<std::size_t>(depth.edge[n]);
      const double t = depth.along[n];
      thickness = (1.0 - t) * samples[e].thickness + t * samples[(e + 1) % samples.size()].thickness;
    }
    field.values[n] = static_cast<float>(std::clamp(field.values[n] - thickness, -4.0, 4.0));
    allowed.values[n] = static_cast<float>(std::clamp(allowed.values[n] - m_Parameters.minimumDistance, -9.0, 9.0));
  }
  SmoothField(field, 0.6);
  return this->Regularise(field, allowed);
}

std::vector<Polygon>
LayerFinder::FindMedullary(const BonePiece & piece, const PlaneField & plane) const
{
  if (piece.endosteal.empty())
  {
    return {};
  }
  const double margin = m_Parameters.smallestRadius + 3.0 * m_Spacing.maxCoeff();
  PlaneField   allowed =
    ComputeDistanceField({ piece.endosteal }, this->GridAround(piece.endosteal, margin), 2.0 * margin).distance;
  PlaneField field = allowed;
  PlaneField weight = allowed;
  for (int j = 0; j < field.grid.size[1]; ++j)
  {
    for (int i = 0; i < field.grid.size[0]; ++i)
    {
      const std::size_t n = field.grid.Offset(i, j);
      // 100 HU below the threshold count as 1 mm; only what lies within the endosteal contour is averaged.
      const double dark = (m_Parameters.medullaryThreshold - plane.Sample(field.grid.Node(i, j))) / 100.0;
      weight.values[n] = allowed.values[n] > 0.0F ? 1.0F : 0.0F;
      field.values[n] = weight.values[n] * static_cast<float>(std::clamp(dark, -1.0, 2.0));
      allowed.values[n] = static_cast<float>(std::clamp(allowed.values[n] - m_Parameters.minimumDistance, -9.0, 9.0));
    }
  }
  SmoothField(field, 1.2);
  SmoothField(weight, 1.2);
  for (std::size_t n = 0; n < field.values.size(); ++n)
  {
    field.values[n] /= std::max(weight.values[n], 1e-3F);
  }
  for (std::size_t n = 0; n < field.values.size(); ++n)
  {
    field.values[n] = std::min(field.values[n], allowed.values[n]);
  }
  return this->Regularise(field, allowed);
}

// Samples of a few slices, found by position.
class SampleBuckets
{
public:
  SampleBuckets(const SliceSamples & samples, double cell)
    : m_Cell(cell)
  {
    for (const auto & piece : samples)
    {
      for (const SurfaceSample & sample : piece)
      {
        m_Buckets[{ CellOf(sample.position.x()), CellOf(sample.position.y()) }].push_back(&sample);
      }
    }
  }

  template <typename TVisit>
  void
  Visit(const Vector2 & q, TVisit && visit) const
  {
    for (int i = CellOf(q.x()) - 1; i <= CellOf(q.x()) + 1; ++i)
    {
      for (int j = CellOf(q.y()) - 1; j <= CellOf(q.y()) + 1; ++j)
      {
        const auto found = m_Buckets.find({ i, j });
        if (found != m_Buckets.end())
        {
          std::for_each(found->second.begin(), found->second.end(), visit);
        }
      }
    }
  }

private:
  int
  CellOf(double x) const
  {
    return static_cast<int>(std::floor(x / m_Cell));
  }

  double                                                            m_Cell;
  std::map<std::pair<int, int>, std::vector<const SurfaceSample *>> m_Buckets;
};

double
WeightedMedian(std::vector<std::pair<double, double>> & values)
{
  std::sort(values.begin(), values.end());
  const double total =
    std::accumulate(values.begin(), values.end(), 0.0, [](double sum, const auto & v) { return sum + v.second; });
  double passed = 0.0;
  for (const auto & value : values)
  {
    passed += value.second;
    if (passed >= 0.5 * total)
    {
      return value.first;
    }
  }
  return values.back().first;
}

// One pass of a filter of thickness over the surface within two standard deviations, median or mean.
std::vector<SliceSamples>
FilterThickness(const std::vector<BoneSection> &  sections,
                const std::vector<SliceSamples> & samples,
                double                            sigma,
                bool                              median,
                const ParallelFor &               parallel)
{
  const double               reach = 2.0 * sigma;
  std::vector<SampleBuckets> buckets;
  for (const SliceSamples & slice : samples)
  {
    buckets.emplace_back(slice, reach);
  }
  std::vector<SliceSamples> result = samples;
  parallel(samples.size(), [&](std::size_t k) {
    std::vector<std::pair<double, double>> values; // thickness, weight
    for (auto & piece : result[k])
    {
      for (SurfaceSample & sample : piece)
      {
        values.clear();
        for (std::size_t other = 0; other < samples.size(); ++other)
        {
          const double dz = sections[other].height - sections[k].height;
          if (std::abs(dz) > reach)
          {
            continue;
          }
          buckets[other].Visit(sample.position, [&](const SurfaceSample * s) {
            const double squared = (s->position - sample.position).squaredNorm() + dz * dz;
            if (squared <= reach * reach && s->inward.dot(sample.inward) > 0.0)
            {
              values.emplace_back(s->thickness, std::exp(-0.5 * squared / (sigma * sigma)));
            }
          });
        }
        if (median)
        {
          sample.thickness = WeightedMedian(values);
          continue;
        }
        double sum = 0.0;
        double weights = 0.0;
        for (const auto & value : values)
        {
          sum += value.first * value.second;
          weights += value.second;
        }
        sample.thickness = sum / weights;
      }
    }
  });
  return result;
}

// Slices that a chain of the given height has, at least three.
int
SlicesIn(double length, const std::vector<BoneSection> & sections)
{
  const double height = sections.back().height - sections.front().height;
  const double step = height / static_cast<double>(std::max<std::size_t>(1, sections.size() - 1));
  return step > 0.0 ? std::max(3, static_cast<int>(std::lround(length / step)) + 1) : 1;
}

} // namespace

std::vector<std::string>
FindInnerLayers(std::vector<BoneSection> & sections,
                const PlaneSource &        planes,
                const Vector2 &            pixel,
                const LayerParameters &    parameters,
                const ParallelFor &        parallel)
{
  if (sections.empty() || parameters.numberOfLayers < 2)
  {
    return {};
  }
  const LayerFinder         finder(planes, pixel, parameters);
  std::vector<SliceSamples> samples(sections.size());
  parallel(sections.size(), [&](std::size_t k) { samples[k] = finder.MeasureThickness(sections[k]); });
  samples = FilterThickness(sections, samples, parameters.smoothing, true, parallel);
  samples = FilterThickness(sections, samples, 0.7 * parameters.smoothing, false, parallel);

  LayerCandidates candidates(sections.size());
  parallel(sections.size(), [&](std::size_t k) {
    for (std::size_t p = 0; p < sections[k].pieces.size(); ++p)
    {
      candidates[k].push_back(finder.FindEndosteal(sections[k].pieces[p], samples[k][p]));
    }
  });
  const auto report = [](std::vector<std::string> & lines, int count, const char * what) {
    if (count > 0)
    {
      lines.push_back("Left out " + std::to_string(count) + ' ' + what + " contours too small or on too few slices.");
    }
  };
  std::vector<std::string> lines;
  report(lines,
         ChooseLastingLayers(sections,
                             &BonePiece::endosteal,
                             candidates,
                             parameters.smallestArea,
                             SlicesIn(parameters.minimumLength, sections)),
         "endosteal");
  if (parameters.numberOfLayers < 3)
  {
    return lines;
  }
  parallel(sections.size(), [&](std::size_t k) {
    const PlaneField plane = sections[k].pieces.empty() ? PlaneField{} : finder.PlaneOf(sections[k]);
    for (std::size_t p = 0; p < sections[k].pieces.size(); ++p)
    {
      candidates[k][p] = finder.FindMedullary(sections[k].pieces[p], plane);
    }
  });
  report(lines,
         ChooseLastingLayers(sections,
                             &BonePiece::medullary,
                             candidates,
                             parameters.smallestCavity,
                             SlicesIn(parameters.cavityLength, sections)),
         "medullary");
  return lines;
}
} // namespace bone
