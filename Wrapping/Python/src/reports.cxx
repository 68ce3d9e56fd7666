/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "reports.h"

namespace bone::python
{
namespace
{
/** Numbers of what was refused, by reason. */
template <typename TCounts>
py::dict
DescribeRefusals(const TCounts & counts)
{
  py::dict dict;
  for (int i = 1; i < MeshOperationCount; ++i)
  {
    dict[MeshOperationName(static_cast<MeshOperation>(i))] = counts[static_cast<std::size_t>(i)];
  }
  return dict;
}
} // namespace

py::dict
DescribeReport(const ExtractionReport & report)
{
  py::list slices;
  for (const SliceReport & slice : report.slices)
  {
    slices.append(py::dict(py::arg("height") = slice.height,
                           py::arg("iterations") = slice.iterations,
                           py::arg("converged") = slice.converged,
                           py::arg("energy") = slice.energy,
                           py::arg("support") = slice.support,
                           py::arg("events") = slice.events));
  }
  return py::dict(py::arg("slices") = slices,
                  py::arg("warnings") = report.warnings,
                  py::arg("doubts") = report.doubts,
                  py::arg("brighter_share") = report.brighterShare);
}

py::dict
DescribeReport(const SamplingReport & report)
{
  return py::dict(py::arg("samples") = report.samples,
                  py::arg("moved") = report.moved,
                  py::arg("near") = report.near,
                  py::arg("refined") = report.refined,
                  py::arg("unfitted") = report.unfitted,
                  py::arg("largest_error") = report.largestError);
}

py::dict
DescribeReport(const TilingReport & report)
{
  return py::dict(py::arg("sections") = report.sections,
                  py::arg("slabs") = report.slabs,
                  py::arg("branchings") = report.branchings,
                  py::arg("split_branchings") = report.splitBranchings,
                  py::arg("filled_branchings") = report.filledBranchings,
                  py::arg("split_fillings") = report.splitFillings,
                  py::arg("layer_branchings") = report.layerBranchings,
                  py::arg("caps") = report.caps,
                  py::arg("flat_cuts") = report.flatCuts,
                  py::arg("edges_refined") = report.edgesRefined,
                  py::arg("patches") = report.patches,
                  py::arg("loops_left_out") = report.loopsLeftOut,
                  py::arg("holes_left_out") = report.holesLeftOut,
                  py::arg("axes_recomputed") = report.axesRecomputed,
                  py::arg("alternative_knits") = report.alternativeKnits,
                  py::arg("other_axes") = report.otherAxes,
                  py::arg("filled_slabs") = report.filledSlabs,
                  py::arg("filled_ends") = report.filledEnds,
                  py::arg("separated_groups") = report.separatedGroups,
                  py::arg("notes") = report.notes);
}

py::dict
DescribeReport(const SmoothingReport & report)
{
  return py::dict(py::arg("moves") = report.moves,
                  py::arg("weighted") = report.weighted,
                  py::arg("refused") = DescribeRefusals(report.refused));
}

py::dict
DescribeReport(const FlipReport & report)
{
  return py::dict(py::arg("done") = report.done, py::arg("refused") = DescribeRefusals(report.refused));
}

py::dict
DescribeReport(const ImprovementReport & report)
{
  return py::dict(py::arg("smoothing") = DescribeReport(report.smoothing),
                  py::arg("flips") = report.flips,
                  py::arg("repairs") = report.repairs,
                  py::arg("splits") = report.splits,
                  py::arg("collapses") = report.collapses,
                  py::arg("contour_flips") = report.contourFlips,
                  py::arg("sharp_edges") = report.sharpEdges,
                  py::arg("optimized") = report.optimized);
}

py::dict
DescribeReport(const DensityFitReport & report)
{
  return py::dict(py::arg("samples") = report.samples,
                  py::arg("outside") = report.outside,
                  py::arg("finite") = report.finite,
                  py::arg("voxels") = report.voxels,
                  py::arg("sparse") = report.sparse,
                  py::arg("unsupported") = report.unsupported,
                  py::arg("limited") = report.limited,
                  py::arg("overshoot_median") = report.overshootMedian,
                  py::arg("overshoot_90") = report.overshoot90,
                  py::arg("overshoot_maximum") = report.overshootMaximum);
}

py::dict
DescribeReport(const RegistrationReport & report)
{
  Eigen::Matrix4d alignment = Eigen::Matrix4d::Identity();
  alignment.topLeftCorner<3, 3>() = report.alignment.linear;
  alignment.topRightCorner<3, 1>() = report.alignment.translation;
  return py::dict(py::arg("alignment") = alignment,
                  py::arg("alignment_distance") = report.alignmentDistance,
                  py::arg("mirrored") = report.mirrored,
                  py::arg("surface_distance") = report.surfaceDistance,
                  py::arg("subject_distance") = report.subjectDistance,
                  py::arg("layer_distance") = report.layerDistance,
                  py::arg("untangling") = py::dict(py::arg("before") = report.untangling.before,
                                                   py::arg("after") = report.untangling.after,
                                                   py::arg("moved") = report.untangling.moved,
                                                   py::arg("exterior") = report.untangling.exterior));
}

py::dict
DescribeReport(const RadiographPreprocessReport & report)
{
  py::list edges;
  for (const CollimatorEdge & edge : report.collimator)
  {
    edges.append(
      py::dict(py::arg("normal") = py::make_tuple(edge.normal.x(), edge.normal.y()), py::arg("offset") = edge.offset));
  }
  return py::dict(py::arg("open_beam") = report.openBeam,
                  py::arg("open_beam_estimated") = report.openBeamEstimated,
                  py::arg("air_share") = report.airShare,
                  py::arg("collimator") = edges,
                  py::arg("not_finite") = report.notFinite,
                  py::arg("dead_pixels") = report.deadPixels,
                  py::arg("saturated") = report.saturated,
                  py::arg("used_share") = report.usedShare,
                  py::arg("scatter_to_primary") = report.scatterToPrimary,
                  py::arg("scatter_iterations") = report.scatterIterations,
                  py::arg("monotone_only") = report.monotoneOnly);
}

py::dict
DescribeReport(const TetraCollapseFilter<Mesh>::LevelReport & report)
{
  return py::dict(py::arg("collapses") = report.collapses,
                  py::arg("refused") = DescribeRefusals(report.refused),
                  py::arg("cell_error") = report.cellError);
}
} // namespace bone::python
