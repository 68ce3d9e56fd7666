/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourExtraction.h"

#include "boneLabelContours.h"
#include "boneSectionExtraction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace bone
{
namespace
{
std::vector<Section>
SectionsFromLabel(const SliceFrame &           frame,
                  const LabelVoxels &          label,
                  const ExtractionParameters & parameters,
                  const Execution &            execution,
                  ExtractionReport &           report)
{
  const VoxelBox &     box = label.box;
  const LabelField     field(box, label.inside, 0.8, execution.Part(0.0, 0.5));
  std::vector<Polygon> corners(1);
  for (int c = 0; c < 8; ++c)
  {
    const Vector3 index((c & 1) * (box.size[0] - 1), (c >> 1 & 1) * (box.size[1] - 1), (c >> 2) * (box.size[2] - 1));
    const Vector3 corner = box.origin + box.direction * index.cwiseProduct(box.spacing);
    corners[0].push_back({ corner.dot(frame.u), corner.dot(frame.v) });
  }
  const PlaneGrid grid = CoveringGrid(corners, 0.0, frame.origin, frame.pixel);
  auto sections = parameters.followLabel ? PlaceSectionsThrough(frame.slices, label.low, parameters.sliceStep)
                                         : PlaceSections(frame.slices, label.low, label.high, parameters.sliceStep);
  if (sections.empty())
  {
    throw std::runtime_error("The label lies beyond the CT's slices; are both images of the same space?");
  }
  std::vector<int> dropped(sections.size(), 0);
  const double     slack = 0.5 * frame.slices.step;
  execution.Part(0.5, 1.0).For(sections.size(), [&](std::size_t k) {
    if (parameters.followLabel && !(sections[k].height > label.low - slack && sections[k].height < label.high + slack))
    {
      return;
    }
    sections[k].pieces =
      ContoursOfLabel(field, grid, frame.u, frame.v, sections[k].height, parameters.minimumContourArea, dropped[k]);
  });
  const int sum = std::accumulate(dropped.begin(), dropped.end(), 0);
  if (sum > 0)
  {
    report.warnings.push_back("Left out " + std::to_string(sum) + " contours or holes smaller than " +
                              std::to_string(parameters.minimumContourArea) + " mm^2.");
  }
  return sections;
}

std::vector<Section>
SectionsFromContours(const SliceFrame & frame, const ContourStack & initial, const ExtractionParameters & parameters)
{
  double anchor = std::numeric_limits<double>::quiet_NaN();
  for (const ContourSlice & slice : initial.GetSlices())
  {
    if (!slice.contours.empty() && !std::isfinite(anchor))
    {
      anchor = slice.origin.dot(frame.normal);
    }
  }
  if (!std::isfinite(anchor))
  {
    throw std::runtime_error("The input 'InitialContours' holds no contour.");
  }
  return PlaceSectionsThrough(frame.slices, anchor, parameters.sliceStep);
}

// Gives each drawn contour to the section nearest to it.
void
InsertInitialContours(const SliceFrame &           frame,
                      const ContourStack &         initial,
                      const ExtractionParameters & parameters,
                      const ExtractionReport &     report,
                      std::vector<Section> &       sections)
{
  if (!(std::abs(initial.GetNormal().dot(frame.normal)) > 1.0 - 1e-4))
  {
    throw std::runtime_error("The initial contours' planes are not parallel to the image's slices along axis " +
                             std::to_string(parameters.axis) + "; set another Axis or redraw them.");
  }
  std::vector<double> nearest(sections.size(), std::numeric_limits<double>::max());
  for (const ContourSlice & slice : initial.GetSlices())
  {
    const double height = slice.origin.dot(frame.normal);
    const auto   section = std::min_element(sections.begin(), sections.end(), [height](const auto & a, const auto & b) {
      return std::abs(a.height - height) < std::abs(b.height - height);
    });
    std::vector<Polygon> loops;
    for (const Contour & contour : slice.contours)
    {
      if (contour.axis || contour.layer != 0)
      {
        continue;
      }
      Polygon loop;
      for (const Vector3 & point : contour.points)
      {
        loop.push_back({ point.dot(frame.u), point.dot(frame.v) });
      }
      if ((SignedArea(loop) < 0.0) != (contour.region == Region::Outside))
      {
        std::reverse(loop.begin(), loop.end());
      }
      loops.push_back(std::move(loop));
    }
    const double step = parameters.sliceStep > 0.0 ? parameters.sliceStep : frame.slices.step;
    if (!loops.empty() && !(std::abs(section->height - height) <= step))
    {
      std::ostringstream text;
      text << "An initial contour at " << report.told(height) << " mm along axis " << parameters.axis
           << " lies beyond the CT's slices.";
      throw std::runtime_error(text.str());
    }
    const auto k = static_cast<std::size_t>(section - sections.begin());
    if (!loops.empty() && std::abs(section->height - height) < nearest[k])
    {
      nearest[k] = std::abs(section->height - height);
      int dropped = 0;
      section->pieces = GroupPieces(std::move(loops), 0.0, dropped);
    }
  }
}

void
SetOpenEnds(const SliceFrame &           frame,
            const std::vector<Section> & sections,
            ContourStack &               contours,
            ExtractionReport &           report)
{
  const double top = frame.slices.Top();
  const double slack = 0.5 * frame.slices.step;
  const bool   start = sections.front().height < frame.slices.first + slack;
  const bool   end = sections.back().height > top - slack;
  contours.SetOpenStart(start);
  contours.SetOpenEnd(end);
  if (start || end)
  {
    const bool first = report.told.sign > 0.0 ? start : end;
    report.warnings.push_back(std::string("The bone leaves the image at its ") +
                              (start && end ? "first and last"
                               : first      ? "first"
                                            : "last") +
                              " slice; it is cut flat there.");
  }
  const Vector2 last =
    frame.origin + Vector2((frame.size[0] - 1) * frame.pixel.x(), (frame.size[1] - 1) * frame.pixel.y());
  const bool aside = std::any_of(sections.begin(), sections.end(), [&](const Section & section) {
    return std::any_of(section.pieces.begin(), section.pieces.end(), [&](const SectionPiece & piece) {
      return std::any_of(piece.outer.begin(), piece.outer.end(), [&](const Vector2 & q) {
        return (q - frame.origin).minCoeff() < 0.0 || (last - q).minCoeff() < 0.0;
      });
    });
  });
  if (aside)
  {
    report.warnings.push_back("The bone leaves the image at the border of its slices; it is cut there.");
  }
}

/** Share of the area within the outer contours that their holes take. */
double
ShareOfHoles(const std::vector<Section> & sections)
{
  double whole = 0.0, holes = 0.0;
  for (const Section & section : sections)
  {
    for (const SectionPiece & piece : section.pieces)
    {
      whole += SignedArea(piece.outer);
      for (const Polygon & hole : piece.holes)
      {
        holes -= SignedArea(hole);
      }
    }
  }
  return whole > 0.0 ? holes / whole : 0.0;
}

/** By what a label map, or else initial contours, may be wrong ones, or the CT. */
std::vector<std::string>
DoubtInput(const std::vector<Section> & sections, const OutlineContrast & contrast, bool labelled)
{
  constexpr double         mostHoles = 0.4; // a vertebra's take some 0.25
  std::vector<std::string> doubts;
  const double             holes = ShareOfHoles(sections);
  if (labelled && holes > mostHoles)
  {
    doubts.push_back("Holes take " + std::to_string(std::lround(100.0 * holes)) +
                     " % of the area within the outlines: is the label map that of the cortex alone? A bone is to be "
                     "labelled whole, with its marrow.");
  }
  const std::string mismatch = contrast.FindMismatch(labelled ? "label map" : "initial contours");
  const std::string line = mismatch.empty() ? contrast.FindForeignUnits() : mismatch;
  if (!line.empty())
  {
    doubts.push_back(line);
  }
  return doubts;
}
} // namespace

void
ExtractContours(const SliceFrame &             frame,
                const PlaneSource &            planes,
                const LabelVoxels *            label,
                const ContourStack *           initial,
                const SnakeContourParameters & given,
                const Execution &              execution,
                ContourStack &                 contours,
                ExtractionReport &             report)
{
  const ExtractionParameters parameters(given, frame.pixel.maxCoeff(), frame.slices.step);
  std::vector<Section>       sections = label != nullptr
                                          ? SectionsFromLabel(frame, *label, parameters, execution.Part(0.0, 0.3), report)
                                          : SectionsFromContours(frame, *initial, parameters);
  if (label != nullptr && parameters.refineLabelOutline && !parameters.followLabel)
  {
    RefineSections(sections, planes, frame.pixel, parameters, execution.Part(0.3, 0.4), report);
  }
  if (initial != nullptr)
  {
    InsertInitialContours(frame, *initial, parameters, report, sections);
  }
  execution.Report(0.4);
  const double brightest = BrightestWithin(sections, planes, parameters.boneThreshold);
  if (!(brightest >= parameters.boneThreshold))
  {
    std::ostringstream text;
    text << "The CT holds no bone: ";
    if (brightest == std::numeric_limits<double>::lowest())
    {
      text << "no voxel of it lies within the contours";
    }
    else
    {
      text << "within the contours its highest value is " << brightest << ", below BoneThreshold ("
           << parameters.boneThreshold << ')';
    }
    text << ". Do the CT and its start belong together?";
    throw std::runtime_error(text.str());
  }
  if (label == nullptr || parameters.followLabel)
  {
    PropagateSections(sections, planes, frame.pixel, parameters, execution.Part(0.4, 0.6), report);
  }
  FinishSections(sections, planes, frame.pixel, parameters, execution.Part(0.6, 0.93), report);
  if (sections.empty())
  {
    throw std::runtime_error(std::string("No contour is left: ") +
                             (label != nullptr ? "the label has too few voxels, or they do not hang together."
                                               : "the initial contours found no edge of bone to rest on."));
  }
  const OutlineContrast contrast = MeasureContrast(sections, planes, frame.pixel, execution.Part(0.93, 0.95));
  report.brighterShare = contrast.GetBrighterShare();
  report.doubts = DoubtInput(sections, contrast, label != nullptr);
  report.warnings.insert(report.warnings.end(), report.doubts.begin(), report.doubts.end());
  contours.SetFrame(frame.u, frame.v);
  contours.SetSlices(ToSlices(sections, contours));
  SetOpenEnds(frame, sections, contours, report);
}
} // namespace bone
