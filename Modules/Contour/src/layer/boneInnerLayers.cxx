/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneInnerLayers.h"

#include "boneCorticalProfile.h"
#include "boneSnake.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
  // As measured on the profile:
  CorticalEdges edges;
  double        length; // of the profile, mm
};
constexpr double SharpestShare = 0.05;
using LoopSamples = std::vector<SurfaceSample>;
using SliceSamples = std::vector<LoopSamples>; // by loop: each piece's outer contour, then its holes

class LayerFinder
{
public:
  LayerFinder(const PlaneSource & planes, const Vector2 & pixel, const ExtractionParameters & parameters)
    : m_Planes(planes)
    , m_Parameters(parameters)
    , m_Pixel(pixel.maxCoeff())
  {
    for (int a = 0; a < 2; ++a)
    {
      m_Spacing[a] = pixel[a] / std::ceil(pixel[a] / 0.8);
    }
    m_Rules.pixel = m_Pixel;
    m_Rules.endostealThreshold = parameters.endostealThreshold;
  }

  SliceSamples
  MeasureThickness(const Section & section) const;

  /** `samples`: of the slice; `first`: the piece's first loop. */
  std::vector<Polygon>
  FindEndosteal(const SectionPiece & piece, const SliceSamples & samples, std::size_t first) const;

  std::vector<Polygon>
  FindMedullary(const Polygon & endosteal, const PlaneField & plane) const;

  PlaneField
  PlaneOf(const Section & section) const
  {
    std::vector<Polygon> outer;
    for (const SectionPiece & piece : section.pieces)
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

  LoopSamples
  MeasureLoop(const PlaneField & plane, const DistanceField & depth, const Polygon & outline) const;

  CorticalProfile
  ProfileAt(const PlaneField & plane, const DistanceField & depth, const SurfaceSample & sample, double step) const;

  std::vector<Polygon>
  Regularise(PlaneField & field, const PlaneField & allowed, const std::vector<Polygon> & holes) const;

  void
  PartAround(PlaneField & field, const std::vector<Polygon> & holes) const;

  std::vector<Polygon>
  GrowApart(const std::vector<Polygon> & cores, const PlaneGrid & grid) const;

  const PlaneSource &          m_Planes;
  const ExtractionParameters & m_Parameters;
  double                       m_Pixel;
  Vector2                      m_Spacing;
  CorticalRules                m_Rules;
};

SliceSamples
LayerFinder::MeasureThickness(const Section & section) const
{
  SliceSamples result;
  if (section.pieces.empty())
  {
    return result;
  }
  const PlaneField plane = this->PlaneOf(section);
  for (const SectionPiece & piece : section.pieces)
  {
    std::vector<Polygon> outlines(1, ResampleUniform(piece.outer, 1.0));
    for (const Polygon & hole : piece.holes)
    {
      outlines.push_back(ResampleUniform(hole, 1.0));
    }
    const DistanceField depth = ComputeDistanceField(
      outlines, this->GridAround(outlines.front(), m_Pixel), m_Parameters.maximumCorticalThickness + m_Pixel);
    for (const Polygon & outline : outlines)
    {
      result.push_back(this->MeasureLoop(plane, depth, outline));
    }
  }
  return result;
}

// Bone lies to the left of outlines and of holes.
LoopSamples
LayerFinder::MeasureLoop(const PlaneField & plane, const DistanceField & depth, const Polygon & outline) const
{
  const double                 step = 0.25 * m_Spacing.minCoeff();
  const std::size_t            n = outline.size();
  LoopSamples                  result;
  std::vector<CorticalProfile> profiles;
  for (std::size_t i = 0; i < n; ++i)
  {
    const Vector2 tangent = (outline[(i + 2) % n] - outline[(i + n - 2) % n]).normalized();
    result.push_back({ outline[i], { -tangent.y(), tangent.x() }, 0.0, {}, 0.0 });
    profiles.push_back(this->ProfileAt(plane, depth, result.back(), step));
  }
  for (std::size_t i = 0; i < n; ++i)
  {
    const auto &    before = profiles[(i + n - 1) % n].values;
    const auto &    after = profiles[(i + 1) % n].values;
    CorticalProfile mean = profiles[i];
    for (std::size_t k = 0; k < std::min({ before.size(), mean.values.size(), after.size() }); ++k)
    {
      mean.values[k] = 0.25 * (before[k] + 2.0 * mean.values[k] + after[k]);
    }
    result[i].edges = FindCorticalEdges(mean, m_Rules);
    result[i].length = static_cast<double>(mean.values.size()) * step - mean.lead * step;
  }
  return result;
}

// Densities inward from a point of the outline, as far as it is the nearest, and a little outward.
CorticalProfile
LayerFinder::ProfileAt(const PlaneField &    plane,
                       const DistanceField & depth,
                       const SurfaceSample & sample,
                       double                step) const
{
  CorticalProfile profile;
  profile.step = step;
  profile.lead = static_cast<int>(std::ceil(2.5 * m_Pixel / step));
  for (int k = -profile.lead; k * step <= m_Parameters.maximumCorticalThickness; ++k)
  {
    const Vector2 q = sample.position + k * step * sample.inward;
    if (k > 0 && depth.distance.Sample(q) < k * step - 0.75 * m_Pixel)
    {
      break;
    }
    profile.values.push_back(plane.SampleCubic(q));
  }
  return profile;
}

// The blur of the CT's edges: that of the sharpest ones where the cortex is resolved, for surfaces that lie obliquely
// in the slice look more blurred; or what is usual.
double
BlurOf(const std::vector<SliceSamples> & samples, double pixel)
{
  std::vector<double> blurs;
  for (const SliceSamples & slice : samples)
  {
    for (const auto & loop : slice)
    {
      for (const SurfaceSample & sample : loop)
      {
        if (sample.edges.blur > 0.0)
        {
          blurs.push_back(sample.edges.blur);
        }
      }
    }
  }
  constexpr std::size_t enough = 50;
  if (blurs.size() < enough)
  {
    return 0.45 * pixel;
  }
  const auto sharp = blurs.begin() + static_cast<std::ptrdiff_t>(SharpestShare * static_cast<double>(blurs.size()));
  std::nth_element(blurs.begin(), sharp, blurs.end());
  return *sharp;
}

// Depth of the endosteal contour under each sample; the blurred layer's middle stays where it is.
void
SetThickness(SliceSamples & slice, double blur, double least, double pixel)
{
  for (auto & loop : slice)
  {
    for (SurfaceSample & sample : loop)
    {
      const CorticalEdges & edges = sample.edges;
      const double          half = 0.5 * ThicknessOfBlurredLayer(edges.inner - edges.outer, blur);
      const double          depth = 0.5 * (edges.outer + edges.inner) + half;
      sample.thickness = edges.kind == CorticalEdges::Kind::Solid   ? sample.length + pixel
                         : edges.kind == CorticalEdges::Kind::Found ? std::max(least, depth)
                                                                    : least;
    }
  }
}

// The contours of where the field exceeds a level, without those of what is not within.
std::vector<Polygon>
OutlinesOf(const PlaneField & field, double level)
{
  std::vector<Polygon> loops = ExtractLevelContours(field, level);
  loops.erase(std::remove_if(loops.begin(), loops.end(), [](const Polygon & loop) { return SignedArea(loop) <= 0.0; }),
              loops.end());
  return loops;
}

// The narrowest place between a clockwise loop and the loops around or beside it.
std::pair<Vector2, Vector2>
NarrowestPlace(const std::vector<Polygon> & loops, const Polygon & inner)
{
  std::pair<Vector2, Vector2> place(inner.front(), inner.front());
  double                      least = std::numeric_limits<double>::max();
  for (const Polygon & other : loops)
  {
    if (&other == &inner || PointInPolygon(other.front(), inner))
    {
      continue;
    }
    for (const Vector2 & p : inner)
    {
      for (const Vector2 & q : other)
      {
        if ((p - q).squaredNorm() < least)
        {
          least = (p - q).squaredNorm();
          place = { p, q };
        }
      }
    }
  }
  return place;
}

// Parts what goes round a hole at its narrowest, so that a contour bounds it.
void
LayerFinder::PartAround(PlaneField & field, const std::vector<Polygon> & holes) const
{
  for (std::size_t round = 0; round < holes.size(); ++round)
  {
    const std::vector<Polygon> loops = ExtractLevelContours(field, 0.0);
    const auto                 around = std::find_if(loops.begin(), loops.end(), [&holes](const Polygon & loop) {
      return SignedArea(loop) < 0.0 && std::any_of(holes.begin(), holes.end(), [&loop](const Polygon & hole) {
               return PointInPolygon(hole.front(), loop);
             });
    });
    if (around == loops.end())
    {
      return;
    }
    const auto       place = NarrowestPlace(loops, *around);
    const PlaneField away = ComputeDistanceField({ { place.first, place.second } }, field.grid).distance;
    for (std::size_t n = 0; n < field.values.size(); ++n)
    {
      const double distance = std::abs(away.values[n]);
      field.values[n] = std::min(field.values[n], static_cast<float>(distance - m_Parameters.minimumLayerDistance));
    }
  }
}

// Grows the cores by the smallest radius, as far as they stay the least distance apart.
std::vector<Polygon>
LayerFinder::GrowApart(const std::vector<Polygon> & cores, const PlaneGrid & grid) const
{
  const auto              radius = static_cast<float>(m_Parameters.smallestRadius);
  const auto              gap = static_cast<float>(m_Parameters.minimumLayerDistance);
  const double            reach = cores.size() > 1 ? 2.0 * (radius + gap) : radius; // where others matter, further
  const double            limit = reach + 2.0 * m_Spacing.maxCoeff();
  std::vector<PlaneField> inside;
  for (const Polygon & core : cores)
  {
    inside.push_back(ComputeDistanceField({ core }, grid, limit).distance);
  }
  std::vector<Polygon> result;
  for (std::size_t i = 0; i < cores.size(); ++i)
  {
    PlaneField grown = inside[i];
    for (std::size_t n = 0; n < grown.values.size(); ++n)
    {
      for (std::size_t j = 0; j < cores.size(); ++j)
      {
        if (j != i)
        {
          const float parted = 0.5F * (inside[i].values[n] - inside[j].values[n] - gap) - radius;
          grown.values[n] = std::min(grown.values[n], parted);
        }
      }
    }
    for (Polygon & loop : OutlinesOf(grown, -m_Parameters.smallestRadius))
    {
      if (SignedArea(loop) >= 0.4 * m_Parameters.smallestArea)
      {
        result.push_back(std::move(loop));
      }
    }
  }
  return result;
}

// Closes and opens the region where `field` is positive with a disk, within the region where `allowed` is positive, and
// returns the parts that are large enough to be of use. None goes round a hole.
std::vector<Polygon>
LayerFinder::Regularise(PlaneField & field, const PlaneField & allowed, const std::vector<Polygon> & holes) const
{
  const double      radius = m_Parameters.smallestRadius;
  const double      limit = radius + 2.0 * m_Spacing.maxCoeff();
  const PlaneGrid & grid = field.grid;
  const auto        outlines = [&holes](const PlaneField & f, double level) {
    return holes.empty() ? OutlinesOf(f, level) : ExtractLevelContours(f, level);
  };
  auto loops = outlines(field, 0.0);
  loops = outlines(ComputeDistanceField(loops, grid, limit).distance, -radius);
  field = ComputeDistanceField(loops, grid, limit).distance;
  for (std::size_t n = 0; n < field.values.size(); ++n)
  {
    field.values[n] = std::min(field.values[n] - static_cast<float>(radius), allowed.values[n]);
  }
  this->PartAround(field, holes);
  loops = OutlinesOf(field, 0.0);
  auto parts = this->GrowApart(OutlinesOf(ComputeDistanceField(loops, grid, limit).distance, radius), grid);
  parts.erase(std::remove_if(parts.begin(),
                             parts.end(),
                             [&holes](const Polygon & part) {
                               return std::any_of(holes.begin(), holes.end(), [&part](const Polygon & hole) {
                                 return PointInPolygon(hole.front(), part);
                               });
                             }),
              parts.end());
  return parts;
}

std::vector<Polygon>
LayerFinder::FindEndosteal(const SectionPiece & piece, const SliceSamples & samples, std::size_t first) const
{
  std::vector<Polygon> outlines(1 + piece.holes.size());
  for (std::size_t i = 0; i < outlines.size(); ++i)
  {
    for (const SurfaceSample & sample : samples[first + i])
    {
      outlines[i].push_back(sample.position);
    }
  }
  const double        margin = m_Parameters.smallestRadius + 3.0 * m_Spacing.maxCoeff();
  const DistanceField depth =
    ComputeDistanceField(outlines, this->GridAround(piece.outer, margin), m_Parameters.maximumCorticalThickness + 3.0);
  PlaneField allowed = depth.distance;
  PlaneField field = depth.distance;
  for (std::size_t n = 0; n < field.values.size(); ++n)
  {
    double thickness = 0.0;
    if (depth.edge[n] >= 0)
    {
      const LoopSamples & loop = samples[first + static_cast<std::size_t>(depth.polygon[n])];
      const auto          e = static_cast<std::size_t>(depth.edge[n]);
      const double        t = depth.along[n];
      thickness = (1.0 - t) * loop[e].thickness + t * loop[(e + 1) % loop.size()].thickness;
    }
    field.values[n] = static_cast<float>(std::clamp(field.values[n] - thickness, -4.0, 4.0));
    allowed.values[n] =
      static_cast<float>(std::clamp(allowed.values[n] - m_Parameters.minimumLayerDistance, -9.0, 9.0));
  }
  SmoothField(field, 0.6);
  return this->Regularise(field, allowed, piece.holes);
}

std::vector<Polygon>
LayerFinder::FindMedullary(const Polygon & endosteal, const PlaneField & plane) const
{
  const double margin = m_Parameters.smallestRadius + 3.0 * m_Spacing.maxCoeff();
  PlaneField allowed = ComputeDistanceField({ endosteal }, this->GridAround(endosteal, margin), 2.0 * margin).distance;
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
      allowed.values[n] =
        static_cast<float>(std::clamp(allowed.values[n] - m_Parameters.minimumLayerDistance, -9.0, 9.0));
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
  return this->Regularise(field, allowed, {});
}

// Samples of a few slices, found by position.
class SampleBuckets
{
public:
  SampleBuckets(const SliceSamples & samples, double cell)
    : m_Cell(cell)
  {
    for (const auto & loop : samples)
    {
      for (const SurfaceSample & sample : loop)
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

// Between the values whose weights' middles lie about half of all weight: it does not jump where rounding decides.
double
WeightedMedian(std::vector<std::pair<double, double>> & values)
{
  std::sort(values.begin(), values.end());
  const double half =
    0.5 * std::accumulate(values.begin(), values.end(), 0.0, [](double sum, const auto & v) { return sum + v.second; });
  double passed = 0.0;
  double before = 0.0; // where the last value's middle was
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const double middle = passed + 0.5 * values[i].second;
    if (middle >= half)
    {
      const double t = i > 0 ? (half - before) / (middle - before) : 0.0;
      return i > 0 ? (1.0 - t) * values[i - 1].first + t * values[i].first : values[i].first;
    }
    before = middle;
    passed += values[i].second;
  }
  return values.back().first;
}

// One pass of a filter of thickness over the surface within two standard deviations, median or mean.
std::vector<SliceSamples>
FilterThickness(const std::vector<Section> &      sections,
                const std::vector<SliceSamples> & samples,
                double                            sigma,
                bool                              median,
                const Execution &                 execution)
{
  const double               reach = 2.0 * sigma;
  std::vector<SampleBuckets> buckets;
  for (const SliceSamples & slice : samples)
  {
    buckets.emplace_back(slice, reach);
  }
  std::vector<SliceSamples> result = samples;
  execution.For(samples.size(), [&](std::size_t k) {
    std::vector<std::pair<double, double>> values; // thickness, weight
    for (auto & loop : result[k])
    {
      for (SurfaceSample & sample : loop)
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
SlicesIn(double length, const std::vector<Section> & sections)
{
  const double height = sections.back().height - sections.front().height;
  const double step = height / static_cast<double>(std::max<std::size_t>(1, sections.size() - 1));
  return step > 0.0 ? std::max(3, static_cast<int>(std::lround(length / step)) + 1) : 1;
}

} // namespace

std::vector<std::string>
FindInnerLayers(std::vector<Section> &       sections,
                const PlaneSource &          planes,
                const Vector2 &              pixel,
                const ExtractionParameters & parameters,
                const Execution &            execution)
{
  if (sections.empty() || parameters.numberOfLayers < 2)
  {
    return {};
  }
  const LayerFinder         finder(planes, pixel, parameters);
  std::vector<SliceSamples> samples(sections.size());
  execution.Part(0.0, 0.3).For(sections.size(),
                               [&](std::size_t k) { samples[k] = finder.MeasureThickness(sections[k]); });
  const double blur = BlurOf(samples, pixel.maxCoeff());
  execution.Silent().For(sections.size(), [&](std::size_t k) {
    SetThickness(samples[k], blur, parameters.minimumLayerDistance, pixel.maxCoeff());
  });
  samples = FilterThickness(sections, samples, parameters.thicknessSmoothing, true, execution.Part(0.3, 0.4));
  samples = FilterThickness(sections, samples, 0.7 * parameters.thicknessSmoothing, false, execution.Part(0.4, 0.5));

  execution.Part(0.5, 0.8).For(sections.size(), [&](std::size_t k) {
    std::size_t first = 0;
    for (SectionPiece & piece : sections[k].pieces)
    {
      piece.endosteal = finder.FindEndosteal(piece, samples[k], first);
      first += 1 + piece.holes.size();
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
         DropShortLayers(
           sections, &SectionPiece::endosteal, parameters.smallestArea, SlicesIn(parameters.minimumLength, sections)),
         "endosteal");
  if (parameters.numberOfLayers < 3)
  {
    return lines;
  }
  execution.Part(0.8, 1.0).For(sections.size(), [&](std::size_t k) {
    const PlaneField plane = sections[k].pieces.empty() ? PlaneField{} : finder.PlaneOf(sections[k]);
    for (SectionPiece & piece : sections[k].pieces)
    {
      piece.medullary.clear();
      for (const Polygon & endosteal : piece.endosteal)
      {
        const auto found = finder.FindMedullary(endosteal, plane);
        piece.medullary.insert(piece.medullary.end(), found.begin(), found.end());
      }
    }
  });
  report(lines,
         DropShortLayers(
           sections, &SectionPiece::medullary, parameters.smallestCavity, SlicesIn(parameters.cavityLength, sections)),
         "medullary");
  return lines;
}
} // namespace bone
