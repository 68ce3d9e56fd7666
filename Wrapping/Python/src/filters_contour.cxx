/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "reports.h"

#include "boneContourResampleFilter.h"
#include "boneContourSliceFilter.h"
#include "boneContourTilingMeshSource.h"
#include "boneMedialAxisFilter.h"
#include "boneSnakeContourFilter.h"

namespace bone::python
{
namespace
{
using SnakeType = SnakeContourFilter<CTImage>;
using TilingType = ContourTilingMeshSource<Mesh>;

/** A filter from contours to contours. */
template <typename TFilter>
FilterClass<TFilter>
AddContourFilter(py::module_ & m, const char * name, const char * doc)
{
  auto filter = AddFilter<TFilter>(m, name, doc);
  AddInput<ContourStack>(filter, "contours", BONE_PYTHON_INPUT(TFilter, Input), "ContourStack.");
  AddParameters(filter);
  AddOutput(
    filter, "output", [](TFilter & self) { return self.GetOutput(); }, "ContourStack.");
  return filter;
}

void
BindSnake(py::module_ & m)
{
  auto snake = AddFilter<SnakeType>(
    m,
    "SnakeContourFilter",
    "Periosteal, endosteal and medullary contours of a bone in a CT, slice by slice, by active contours.\n\n"
    "Inputs: image; labels or initial_contours say where the bone is. Output: ContourStack.");
  AddImageInput(snake, "image", BONE_PYTHON_INPUT(SnakeType, Input), "CT in HU.");
  AddLabelInput(snake, "labels", BONE_PYTHON_INPUT(SnakeType, LabelImage), "Label map; optional.");
  AddInput<ContourStack>(
    snake, "initial_contours", BONE_PYTHON_INPUT(SnakeType, InitialContours), "ContourStack to start from; optional.");
  AddParameters(snake);
  AddOutput(
    snake, "output", [](SnakeType & self) { return self.GetOutput(); }, "ContourStack.");
  AddReport(
    snake,
    "After an update: a dict of slices (dicts of height, iterations, converged, energy, support and events), warnings, "
    "doubts (the warnings by which the image may not belong to its start, or not be in HU) and brighter_share (of the "
    "outline, where the image is brighter inside than outside).");
  snake.def_property_readonly("warnings", &SnakeType::GetWarnings, "What a person should know, after an update.");
}
} // namespace

void
BindContourFilters(py::module_ & m)
{
  BindSnake(m);
  AddContourFilter<ContourSliceFilter>(
    m,
    "ContourSliceFilter",
    "Keeps the slices of a stack from which the others are best interpolated. Input: contours. Output: ContourStack.");
  auto resample = AddContourFilter<ContourResampleFilter>(
    m,
    "ContourResampleFilter",
    "Fits closed cubic B-splines to contours and samples them by curvature. Input: contours. Output: ContourStack.");
  AddReport(resample,
            "After an update: a dict of samples, moved, near, refined and unfitted (numbers), and largest_error (mm).");
  resample
    .def_property_readonly(
      "spacing_scale", &ContourResampleFilter::GetSpacingScale, "Factor of all spacings, after an update.")
    .def_property_readonly(
      "warnings", &ContourResampleFilter::GetWarnings, "What a person should know, after an update.");
  AddContourFilter<MedialAxisFilter>(
    m, "MedialAxisFilter", "Adds the medial axes of the innermost contours. Input: contours. Output: ContourStack.");

  auto tiling = AddFilter<TilingType>(
    m,
    "ContourTilingMeshSource",
    "Tiles a stack of nested contours into a layered tetrahedral mesh.\n\n"
    "Inputs: contours; density_image (CT), optional, for the metrics density and combined. Output: DensityMesh.");
  AddInput<ContourStack>(tiling, "contours", BONE_PYTHON_INPUT(TilingType, Input), "ContourStack.");
  AddImageInput(tiling, "density_image", BONE_PYTHON_INPUT(TilingType, DensityImage), "CT; optional.");
  AddParameters(tiling);
  AddOutput(
    tiling, "output", [](TilingType & self) { return self.GetOutput(); }, "DensityMesh without density.");
  AddReport(tiling,
            "After an update: a dict of numbers, as of sections, slabs, branchings, caps and flat_cuts, and notes, the "
            "places behind them.");
}
} // namespace bone::python
