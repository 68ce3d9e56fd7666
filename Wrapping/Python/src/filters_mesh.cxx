/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "reports.h"

#include "boneHierarchyLevelFilter.h"
#include "boneMeshQualityFilter.h"
#include "boneTetraCollapseFilter.h"
#include "boneTetraSmoothingFilter.h"
#include "boneTetraSwapFilter.h"

namespace bone::python
{
namespace
{
using QualityType = MeshQualityFilter<Mesh>;
using CollapseType = TetraCollapseFilter<Mesh>;

template <typename TFilter>
FilterClass<TFilter>
AddMeshFilter(py::module_ & m, const char * name, const char * doc)
{
  auto filter = AddFilter<TFilter>(m, name, doc);
  AddInput<Mesh>(filter, "mesh", BONE_PYTHON_INPUT(TFilter, Input), "DensityMesh.");
  AddParameters(filter);
  AddOutput(
    filter, "output", [](TFilter & self) { return self.GetOutput(); }, "DensityMesh without density.");
  return filter;
}
} // namespace

void
BindMeshFilters(py::module_ & m)
{
  auto quality = AddMeshFilter<QualityType>(
    m,
    "MeshQualityFilter",
    "Makes a tiled mesh fit for computing by rounds of smoothing, swaps and optimisation.\n\n"
    "Inputs: mesh; contours, optional, what it was tiled from; labels, optional, the bone as voxels.");
  AddInput<ContourStack>(quality, "contours", BONE_PYTHON_INPUT(QualityType, Contours), "ContourStack; optional.");
  AddLabelInput(quality, "labels", BONE_PYTHON_INPUT(QualityType, LabelImage), "Label map; optional.");
  AddReport(
    quality,
    "After an update: a dict of smoothing (see TetraSmoothingFilter.report) and numbers of flips, repairs, splits, "
    "collapses, contour_flips, sharp_edges and points optimized.");
  auto smoothing = AddMeshFilter<TetraSmoothingFilter<Mesh>>(
    m,
    "TetraSmoothingFilter",
    "Smooths a layered tetrahedral mesh without shrinking it, inverting cells or mixing layers. Input: mesh.");
  AddReport(
    smoothing,
    "After an update: a dict of moves, weighted, and refused, points left where they were by reason (numbers).");
  auto swap = AddMeshFilter<TetraSwapFilter<Mesh>>(
    m, "TetraSwapFilter", "Swaps faces and edges where that makes the worst cells better. Input: mesh.");
  AddReport(swap, "After an update: a dict of swaps done, and refused by reason (numbers).");

  auto collapse = AddFilter<CollapseType>(
    m,
    "TetraCollapseFilter",
    "Simplifies a layered density mesh by edge collapse into a hierarchy of levels. Input: mesh.");
  AddInput<Mesh>(collapse, "mesh", BONE_PYTHON_INPUT(CollapseType, Input), "DensityMesh, valid.");
  AddParameters(collapse);
  AddOutput(
    collapse, "output", [](CollapseType & self) { return self.GetOutput(); }, "DensityHierarchy.");
  AddReport(collapse,
            "After an update: for each level after the first a dict of collapses, refused by reason (numbers) and "
            "cell_error (density "
            "units).");

  auto level = AddFilter<HierarchyLevelFilter>(
    m, "HierarchyLevelFilter", "Hands one level of a hierarchy on as a mesh. Input: hierarchy.");
  AddInput<DensityHierarchy<>>(
    level,
    "hierarchy",
    [](HierarchyLevelFilter & self) {
      return static_cast<DensityHierarchy<> *>(self.GetInputs().empty() ? nullptr : self.GetInputs()[0].GetPointer());
    },
    [](HierarchyLevelFilter & self, const DensityHierarchy<> * data) { self.SetInput(data); },
    "DensityHierarchy.");
  level.def_property("level",
                     &HierarchyLevelFilter::GetLevel,
                     &HierarchyLevelFilter::SetLevel,
                     "Index of the level; 0, the finest, by default.");
  AddOutput(
    level, "output", [](HierarchyLevelFilter & self) { return self.GetOutput(); }, "DensityMesh.");
}
} // namespace bone::python
