/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionExtraction.h"

#include "boneInnerLayers.h"
#include "boneSnake.h"
#include "boneSectionFollower.h"
#include "boneLayerDistance.h"
#include "bonePlanarCrossing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

namespace bone
{
namespace
{
std::vector<Polygon>
LoopsOf(const Section & section)
{
  std::vector<Polygon> loops;
  for (const SectionPiece & piece : section.pieces)
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
  return parameters.edgeSmoothing > 0.0 ? parameters.edgeSmoothing : 0.5 * pixel.maxCoeff();
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
  report.events += (report.events.empty() ? "" : "; ") + event;
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

// Snakes on a slice of followed bone.
class SliceSnakes
{
public:
  SliceSnakes(const PlaneSource & planes, const Vector2 & pixel, const ExtractionParameters & parameters)
    : m_Planes(planes)
    , m_Pixel(pixel)
    , m_Parameters(parameters)
  {}

  // Draws the outlines of the pieces to the bone's edges; keeps them where that makes them cross.
  void
  Settle(Section & section, bool drawn, SliceReport & report) const
  {
    if (section.pieces.empty())
    {
      return;
    }
    const std::vector<Polygon> start = LoopsOf(section);
    const PlaneField           plane = PlaneAround(start, section.height, 12.0 * m_Pixel.maxCoeff(), m_Planes);
    const BoneEdges            edges(
      plane, drawn ? start : std::vector<Polygon>{}, Smoothing(m_Parameters, m_Pixel), m_Parameters.minimumEdgeSlope);
    std::vector<Polygon> loops;
    for (const Polygon & loop : start)
    {
      // A hole is clockwise: its outward normal points into the hole, away from bone, as the outer contour's does.
      SnakeResult snake = drawn ? EvolveSnake(loop, edges, m_Parameters)
                                : RefineSnake(loop, edges, 2.0 * m_Pixel.maxCoeff(), m_Parameters);
      const bool  turned = SignedArea(snake.contour) * SignedArea(loop) <= 0.0;
      AddResult(snake, report);
      loops.push_back(snake.contour.empty() || turned ? loop : std::move(snake.contour));
    }
    if (AnyCrossing(loops))
    {
      loops = UnionOutline(loops, m_Pixel.maxCoeff());
      AddEvent(report, "contours met and were joined or parted");
    }
    int dropped = 0;
    section.pieces = GroupPieces(std::move(loops), m_Parameters.minimumContourArea, dropped);
  }

private:
  const PlaneSource &          m_Planes;
  Vector2                      m_Pixel;
  const ExtractionParameters & m_Parameters;
};

// What a person should look at, by event, with the heights between which it happened.
std::vector<std::string>
SummariseEvents(const ExtractionReport & report)
{
  struct Range
  {
    double low;
    double high;
    int    count;
  };
  const std::vector<std::string> usual = { "the bone ends", "another piece joins" };
  std::map<std::string, Range>   ranges;
  for (const SliceReport & slice : report.slices)
  {
    std::istringstream events(slice.events);
    for (std::string event; std::getline(events >> std::ws, event, ';');)
    {
      if (std::find(usual.begin(), usual.end(), event) == usual.end())
      {
        const double height = report.told(slice.height);
        const auto   found = ranges.insert({ event.substr(0, event.find(", by a")), { height, height, 0 } });
        found.first->second.low = std::min(found.first->second.low, height);
        found.first->second.high = std::max(found.first->second.high, height);
        ++found.first->second.count;
      }
    }
  }
  std::vector<std::string> lines;
  for (const auto & item : ranges)
  {
    std::ostringstream line;
    line << "Look at the contours ";
    if (item.second.count > 1)
    {
      line << "between " << item.second.low << " and " << item.second.high << " mm (" << item.second.count
           << " slices)";
    }
    else
    {
      line << "at " << item.second.low << " mm";
    }
    line << ": " << item.first << '.';
    lines.push_back(line.str());
  }
  return lines;
}

std::vector<Section>
EvenSections(double first, double step, double last, double slack)
{
  std::vector<Section> sections;
  for (int k = 0; first + k * step <= last + slack; ++k)
  {
    sections.push_back({ first + k * step, {} });
  }
  return sections;
}

// Moves `inner` away from `fixed`, unless it would then cross something.
void
KeepApart(Polygon & inner, const Polygon & fixed, bool inside, double distance)
{
  const Polygon before = inner;
  MoveAway(inner, fixed, inside, distance);
  if (AnyCrossing({ inner, fixed }))
  {
    inner = before;
  }
}

// Inner layers come from a grid, a little off their least distance. What cannot be had without crossings is left.
void
KeepLayersApart(SectionPiece & piece, double distance)
{
  const SectionPiece before = piece;
  for (Polygon & endosteal : piece.endosteal)
  {
    KeepApart(endosteal, piece.outer, true, distance);
    for (const Polygon & hole : piece.holes)
    {
      KeepApart(endosteal, hole, false, distance);
    }
  }
  for (Polygon & medullary : piece.medullary)
  {
    for (const Polygon & endosteal : piece.endosteal)
    {
      if (PointInPolygon(medullary.front(), endosteal))
      {
        KeepApart(medullary, endosteal, true, distance);
      }
    }
  }
  std::vector<Polygon> loops = piece.holes;
  loops.push_back(piece.outer);
  loops.insert(loops.end(), piece.endosteal.begin(), piece.endosteal.end());
  loops.insert(loops.end(), piece.medullary.begin(), piece.medullary.end());
  if (AnyCrossing(loops))
  {
    piece = before;
  }
}
} // namespace

std::vector<Section>
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

std::vector<Section>
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
BrightestWithin(const std::vector<Section> & sections, const PlaneSource & planes, double enough)
{
  double brightest = std::numeric_limits<double>::lowest();
  for (const Section & section : sections)
  {
    for (const SectionPiece & piece : section.pieces)
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

OutlineContrast
MeasureContrast(const std::vector<Section> & sections,
                const PlaneSource &          planes,
                const Vector2 &              pixel,
                const Execution &            execution)
{
  const double inward = 0.5 * pixel.maxCoeff();
  const double outward = OutlineContrast::ReachOutside(pixel.maxCoeff());
  // Beyond the image there is nothing to compare.
  const auto value = [](const PlaneField & plane, const Vector2 & q) {
    const Vector2 last = plane.grid.Node(plane.grid.size[0] - 1, plane.grid.size[1] - 1);
    const bool    within = (q - plane.grid.origin).minCoeff() >= 0.0 && (last - q).minCoeff() >= 0.0;
    return within ? plane.Sample(q) : std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<OutlineContrast> found(sections.size());
  execution.For(sections.size(), [&](std::size_t k) {
    for (const SectionPiece & piece : sections[k].pieces)
    {
      const PlaneField plane = PlaneAround({ piece.outer }, sections[k].height, outward, planes);
      for (std::size_t i = 0; i < piece.outer.size(); ++i)
      {
        const Vector2 & a = piece.outer[i];
        const Vector2   edge = piece.outer[(i + 1) % piece.outer.size()] - a;
        const double    length = edge.norm();
        if (length > 0.0)
        {
          const Vector2 middle = a + 0.5 * edge, outside = Vector2(edge.y(), -edge.x()) / length;
          found[k].Add(value(plane, middle - inward * outside), value(plane, middle + outward * outside), length);
        }
      }
    }
  });
  OutlineContrast all;
  for (const OutlineContrast & one : found)
  {
    all.Add(one);
  }
  return all;
}

void
RefineSections(std::vector<Section> &       sections,
               const PlaneSource &          planes,
               const Vector2 &              pixel,
               const ExtractionParameters & parameters,
               const Execution &            execution,
               ExtractionReport &           report)
{
  report.slices.resize(sections.size());
  execution.For(sections.size(), [&](std::size_t k) {
    Section &     section = sections[k];
    SliceReport & line = report.slices[k];
    line.height = section.height;
    if (section.pieces.empty())
    {
      return;
    }
    const std::vector<Polygon> start = LoopsOf(section);
    const PlaneField           plane = PlaneAround(start, section.height, 8.0 * pixel.maxCoeff(), planes);
    const BoneEdges            edges(plane, {}, Smoothing(parameters, pixel), parameters.minimumEdgeSlope);
    Section                    refined = section;
    // A hole is clockwise: its outward normal points into the hole, away from bone, as the outer contour's does. What
    // finds few edges, or is so small that it shrinks, stays as it is.
    const auto refine = [&](Polygon & loop) {
      SnakeResult result = RefineSnake(loop, edges, parameters.refineDistance, parameters);
      AddResult(result, line);
      if (result.support >= 0.5 && SignedArea(result.contour) / SignedArea(loop) > 0.75)
      {
        loop = std::move(result.contour);
      }
    };
    for (SectionPiece & piece : refined.pieces)
    {
      refine(piece.outer);
      std::for_each(piece.holes.begin(), piece.holes.end(), refine);
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
PropagateSections(std::vector<Section> &       sections,
                  const PlaneSource &          planes,
                  const Vector2 &              pixel,
                  const ExtractionParameters & parameters,
                  const Execution &            execution,
                  ExtractionReport &           report)
{
  FollowParameters following;
  following.threshold = parameters.boneThreshold;
  following.minimumArea = parameters.minimumContourArea;
  std::vector<char> drawn;
  for (const Section & section : sections)
  {
    drawn.push_back(!section.pieces.empty());
  }
  const SectionFollower          follower(planes, pixel, following);
  const std::vector<std::string> events = follower.Follow(sections, parameters.followStep, execution.Part(0.0, 0.7));
  const SliceSnakes              snakes(planes, pixel, parameters);
  report.slices.resize(sections.size());
  execution.Part(0.7, 1.0).For(sections.size(), [&](std::size_t k) {
    report.slices[k].height = sections[k].height;
    report.slices[k].events = events[k];
    snakes.Settle(sections[k], drawn[k] != 0, report.slices[k]);
  });
  const std::vector<std::string> lines = SummariseEvents(report);
  report.warnings.insert(report.warnings.end(), lines.begin(), lines.end());
}

void
FinishSections(std::vector<Section> &       sections,
               const PlaneSource &          planes,
               const Vector2 &              pixel,
               const ExtractionParameters & parameters,
               const Execution &            execution,
               ExtractionReport &           report)
{
  std::vector<std::string> lines;
  if (!parameters.keepSmallPieces)
  {
    lines = DropShortLived(sections, 3, parameters.minimumVolume);
  }
  report.warnings.insert(report.warnings.end(), lines.begin(), lines.end());
  report.slices.resize(sections.size());
  const auto empty = [](const Section & section) { return section.pieces.empty(); };
  const auto first = std::find_if_not(sections.begin(), sections.end(), empty) - sections.begin();
  const auto tail = std::find_if_not(sections.rbegin(), sections.rend(), empty) - sections.rbegin();
  const auto last = std::max(first, static_cast<std::ptrdiff_t>(sections.size()) - tail);
  sections = { sections.begin() + first, sections.begin() + last };
  report.slices = { report.slices.begin() + first, report.slices.begin() + last };
  for (std::size_t k = 0; k < sections.size(); ++k)
  {
    report.slices[k].height = sections[k].height;
  }
  lines = FindInnerLayers(sections, planes, pixel, parameters, execution.Part(0.0, 0.95));
  execution.Part(0.95, 1.0).For(sections.size(), [&](std::size_t k) {
    for (SectionPiece & piece : sections[k].pieces)
    {
      KeepLayersApart(piece, parameters.minimumLayerDistance);
    }
  });
  report.warnings.insert(report.warnings.end(), lines.begin(), lines.end());
}
} // namespace bone
