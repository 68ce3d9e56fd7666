/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourExtraction.h"

#include "bonePlanarCrossing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace bone
{
namespace
{
std::vector<Polygon>
LoopsOf(const BoneSection & section)
{
  std::vector<Polygon> loops;
  for (const BonePiece & piece : section.pieces)
  {
    loops.push_back(piece.outer);
    loops.insert(loops.end(), piece.holes.begin(), piece.holes.end());
  }
  return loops;
}

bool
AnyCrossing(const std::vector<Polygon> & loops)
{
  std::vector<PlanarChain> chains;
  for (const Polygon & loop : loops)
  {
    chains.push_back({ loop, true });
  }
  return FindPlanarCrossing(chains).found;
}

PlaneField
PlaneAround(const std::vector<Polygon> & loops, double height, double margin, const PlaneSource & planes)
{
  const PlaneGrid box = CoveringGrid(loops, margin, Vector2::Zero(), Vector2::Ones());
  return planes(height, box.origin, box.Node(box.size[0] - 1, box.size[1] - 1));
}

double
Smoothing(const ExtractionParameters & parameters, const Vector2 & pixel)
{
  return parameters.edgeSmoothing > 0.0 ? parameters.edgeSmoothing : 0.7 * pixel.maxCoeff();
}

void
AddResult(const SnakeResult & snake, SliceReport & report)
{
  report.iterations += snake.iterations;
  report.converged = report.converged && snake.converged;
  report.energy += snake.energy;
  report.support = std::min(report.support, snake.support);
}

void
AddEvent(SliceReport & report, const std::string & event)
{
  report.events += (report.events.empty() ? "" : ", ") + event;
}

// The contours of the union of the loops' insides (each loop by itself, holes taken away).
std::vector<Polygon>
UnionOutline(const std::vector<Polygon> & loops, double pixel)
{
  const PlaneGrid grid = CoveringGrid(loops, 3.0 * pixel, loops.front().front(), Vector2::Constant(0.5 * pixel));
  PlaneField      field{ grid, std::vector<float>(grid.Count(), -1e9F) };
  for (const bool hole : { false, true })
  {
    for (const Polygon & loop : loops)
    {
      if ((SignedArea(loop) < 0.0) == hole)
      {
        const PlaneField distance = ComputeDistanceField({ loop }, grid).distance;
        for (std::size_t n = 0; n < field.values.size(); ++n)
        {
          field.values[n] =
            hole ? std::min(field.values[n], -distance.values[n]) : std::max(field.values[n], distance.values[n]);
        }
      }
    }
  }
  return ExtractLevelContours(field, 0.0);
}

class Propagation
{
public:
  Propagation(const PlaneSource & planes, const Vector2 & pixel, const ExtractionParameters & parameters)
    : m_Planes(planes)
    , m_Pixel(pixel)
    , m_Parameters(parameters)
  {}

  // The pieces on a slice, started from those of another; empty where all have ended.
  std::vector<BonePiece>
  Step(const BoneSection & from, double height, SliceReport & report) const
  {
    const double               pixel = m_Pixel.maxCoeff();
    const std::vector<Polygon> start = LoopsOf(from);
    const PlaneField           plane = PlaneAround(start, height, 12.0 * pixel, m_Planes);
    const BoneEdges            edges(plane, start, Smoothing(m_Parameters, m_Pixel), m_Parameters.minimumSlope);
    std::vector<Polygon>       loops;
    report.height = height;
    for (const Polygon & loop : start)
    {
      const bool        hole = SignedArea(loop) < 0.0;
      const SnakeResult snake = hole ? EvolveSnake(Reversed(loop), Outwards(plane, start), m_Parameters.snake)
                                     : EvolveSnake(loop, edges, m_Parameters.snake);
      AddResult(snake, report);
      if (snake.contour.empty() || SignedArea(snake.contour) < m_Parameters.minimumArea || snake.support < 0.5 ||
          (!hole && this->Brightest(plane, snake.contour) < m_Parameters.boneThreshold))
      {
        AddEvent(report, hole ? "a hole ends" : "a contour ends");
        continue;
      }
      loops.push_back(hole ? Reversed(snake.contour) : snake.contour);
    }
    if (!loops.empty() && AnyCrossing(loops))
    {
      loops = UnionOutline(loops, pixel);
      AddEvent(report, "contours met and were joined or parted");
    }
    int                    dropped = 0;
    std::vector<BonePiece> pieces = GroupPieces(std::move(loops), m_Parameters.minimumArea, dropped);
    this->NoteChange(from.pieces, pieces, report);
    return pieces;
  }

private:
  static Polygon
  Reversed(Polygon polygon)
  {
    std::reverse(polygon.begin(), polygon.end());
    return polygon;
  }

  // Edges of a hole: bright outside. The image's negative turns them into a bone's.
  BoneEdges
  Outwards(PlaneField plane, const std::vector<Polygon> & start) const
  {
    std::vector<Polygon> holes;
    for (const Polygon & loop : start)
    {
      if (SignedArea(loop) < 0.0)
      {
        holes.push_back(loop);
      }
    }
    for (float & value : plane.values)
    {
      value = -value;
    }
    return BoneEdges(plane, holes, Smoothing(m_Parameters, m_Pixel), m_Parameters.minimumSlope);
  }

  // The highest value just inside a contour.
  double
  Brightest(const PlaneField & plane, const Polygon & contour) const
  {
    double            brightest = -1e30;
    const std::size_t n = contour.size();
    for (std::size_t i = 0; i < n; ++i)
    {
      const Vector2 tangent = (contour[(i + 1) % n] - contour[(i + n - 1) % n]).normalized();
      const Vector2 inside = contour[i] + m_Pixel.maxCoeff() * Vector2(-tangent.y(), tangent.x());
      brightest = std::max(brightest, plane.Sample(inside));
    }
    return brightest;
  }

  void
  NoteChange(const std::vector<BonePiece> & before, const std::vector<BonePiece> & after, SliceReport & report) const
  {
    const auto area = [](const std::vector<BonePiece> & pieces) {
      double sum = 0.0;
      for (const BonePiece & piece : pieces)
      {
        sum += SignedArea(piece.outer);
      }
      return sum;
    };
    const double ratio = area(after) / std::max(area(before), 1e-9);
    if (ratio > 1.5 || (ratio < 0.6 && !after.empty()))
    {
      std::ostringstream text;
      text << "area changes suddenly, by a factor of " << ratio;
      AddEvent(report, text.str());
    }
    if (!after.empty() && before.size() != after.size())
    {
      std::ostringstream text;
      text << before.size() << " pieces become " << after.size();
      AddEvent(report, text.str());
    }
  }

  const PlaneSource &          m_Planes;
  Vector2                      m_Pixel;
  const ExtractionParameters & m_Parameters;
};

std::vector<BoneSection>
EvenSections(double first, double step, double last, double slack)
{
  std::vector<BoneSection> sections;
  for (int k = 0; first + k * step <= last + slack; ++k)
  {
    sections.push_back({ first + k * step, {} });
  }
  return sections;
}
} // namespace

std::vector<BoneSection>
PlaceSections(const SliceRange & slices, double low, double high, double step)
{
  const double slack = 1e-6 * slices.step;
  low = std::max(low, slices.first);
  high = std::min(high, slices.Top());
  if (step > 0.0)
  {
    const double parts = std::max(1.0, std::ceil((high - low - slack) / step));
    return EvenSections(low, high > low ? (high - low) / parts : step, high, slack);
  }
  const double first = slices.first + slices.step * std::floor((low - slices.first) / slices.step + 0.5 - 1e-6);
  return EvenSections(first, slices.step, std::min(high + 0.5 * slices.step - slack, slices.Top()), slack);
}

std::vector<BoneSection>
PlaceSectionsThrough(const SliceRange & slices, double anchor, double step)
{
  const double slack = 1e-6 * slices.step;
  if (!(step > 0.0))
  {
    return EvenSections(slices.first, slices.step, slices.Top(), slack);
  }
  const double first = anchor - step * std::floor((anchor - slices.first + slack) / step);
  return EvenSections(first, step, slices.Top(), slack);
}

double
BrightestWithin(const std::vector<BoneSection> & sections, const PlaneSource & planes, double enough)
{
  double brightest = std::numeric_limits<double>::lowest();
  for (const BoneSection & section : sections)
  {
    for (const BonePiece & piece : section.pieces)
    {
      const PlaneField plane = PlaneAround({ piece.outer }, section.height, 0.0, planes);
      brightest = std::max<double>(brightest, *std::max_element(plane.values.begin(), plane.values.end()));
      if (brightest >= enough)
      {
        return brightest;
      }
    }
  }
  return brightest;
}

void
RefineSections(std::vector<BoneSection> &   sections,
               const PlaneSource &          planes,
               const Vector2 &              pixel,
               const ExtractionParameters & parameters,
               const ParallelFor &          parallel,
               ExtractionReport &           report)
{
  report.slices.resize(sections.size());
  parallel(sections.size(), [&](std::size_t k) {
    BoneSection & section = sections[k];
    SliceReport & line = report.slices[k];
    line.height = section.height;
    if (section.pieces.empty())
    {
      return;
    }
    const std::vector<Polygon> start = LoopsOf(section);
    const PlaneField           plane = PlaneAround(start, section.height, 8.0 * pixel.maxCoeff(), planes);
    const BoneEdges            edges(plane, {}, Smoothing(parameters, pixel), parameters.minimumSlope);
    BoneSection                refined = section;
    for (BonePiece & piece : refined.pieces)
    {
      // A hole is clockwise: its outward normal points into the hole, away from bone, as the outer contour's does.
      SnakeResult result = RefineSnake(piece.outer, edges, parameters.refineDistance, parameters.snake);
      AddResult(result, line);
      piece.outer = std::move(result.contour);
      for (Polygon & hole : piece.holes)
      {
        result = RefineSnake(hole, edges, parameters.refineDistance, parameters.snake);
        AddResult(result, line);
        hole = std::move(result.contour);
      }
    }
    if (AnyCrossing(LoopsOf(refined)))
    {
      AddEvent(line, "refinement given up: contours would cross");
      return;
    }
    section = std::move(refined);
  });
}

void
PropagateSections(std::vector<BoneSection> &   sections,
                  const PlaneSource &          planes,
                  const Vector2 &              pixel,
                  const ExtractionParameters & parameters,
                  const ParallelFor &          parallel,
                  ExtractionReport &           report)
{
  const Propagation        propagation(planes, pixel, parameters);
  std::vector<std::size_t> drawn;
  report.slices.resize(sections.size());
  for (std::size_t k = 0; k < sections.size(); ++k)
  {
    report.slices[k].height = sections[k].height;
    if (!sections[k].pieces.empty())
    {
      drawn.push_back(k);
    }
  }
  parallel(drawn.size(), [&](std::size_t d) {
    BoneSection & section = sections[drawn[d]];
    section.pieces = propagation.Step(section, section.height, report.slices[drawn[d]]);
  });
  // Each run goes from a drawn slice in one direction; it takes half the way to the next drawn one.
  parallel(2 * drawn.size(), [&](std::size_t run) {
    const std::size_t d = run / 2;
    const bool        up = run % 2 == 1;
    std::size_t       last = up ? sections.size() - 1 : 0;
    if (up && d + 1 < drawn.size())
    {
      last = (drawn[d] + drawn[d + 1]) / 2;
    }
    if (!up && d > 0)
    {
      last = (drawn[d - 1] + drawn[d]) / 2 + 1;
    }
    for (std::size_t k = drawn[d]; k != last && !sections[k].pieces.empty();)
    {
      const std::size_t next = up ? k + 1 : k - 1;
      sections[next].pieces = propagation.Step(sections[k], sections[next].height, report.slices[next]);
      k = next;
    }
  });
}

void
FinishSections(std::vector<BoneSection> &   sections,
               const PlaneSource &          planes,
               const Vector2 &              pixel,
               const ExtractionParameters & parameters,
               const ParallelFor &          parallel,
               ExtractionReport &           report)
{
  std::vector<std::string> lines = DropShortLived(sections, 3, parameters.minimumVolume);
  report.warnings.insert(report.warnings.end(), lines.begin(), lines.end());
  report.slices.resize(sections.size());
  const auto empty = [](const BoneSection & section) { return section.pieces.empty(); };
  const auto first = std::find_if_not(sections.begin(), sections.end(), empty) - sections.begin();
  const auto tail = std::find_if_not(sections.rbegin(), sections.rend(), empty) - sections.rbegin();
  const auto last = std::max(first, static_cast<std::ptrdiff_t>(sections.size()) - tail);
  sections = { sections.begin() + first, sections.begin() + last };
  report.slices = { report.slices.begin() + first, report.slices.begin() + last };
  for (std::size_t k = 0; k < sections.size(); ++k)
  {
    report.slices[k].height = sections[k].height;
  }
  lines = FindInnerLayers(sections, planes, pixel, parameters.layers, parallel);
  report.warnings.insert(report.warnings.end(), lines.begin(), lines.end());
}
} // namespace bone
