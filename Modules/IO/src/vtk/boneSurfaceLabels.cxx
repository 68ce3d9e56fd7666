/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceLabels.h"

#include <vtkCellArray.h>
#include <vtkImageStencilData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataToImageStencil.h>

#include <algorithm>

namespace bone
{
namespace
{
/** The surface with its points as continuous indices of the grid, counted from its first voxel: VTK knows no oblique
 * images. */
vtkSmartPointer<vtkPolyData>
ToIndexSpace(const TriangleSurface & surface, const itk::ImageBase<3> * grid)
{
  const auto        start = grid->GetLargestPossibleRegion().GetIndex();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vector3 & p : surface.points)
  {
    itk::Point<double, 3> point;
    std::copy_n(p.data(), 3, point.begin());
    const auto index = grid->TransformPhysicalPointToContinuousIndex<double>(point);
    points->InsertNextPoint(index[0] - static_cast<double>(start[0]),
                            index[1] - static_cast<double>(start[1]),
                            index[2] - static_cast<double>(start[2]));
  }
  vtkNew<vtkCellArray> triangles;
  for (const auto & triangle : surface.triangles)
  {
    triangles->InsertNextCell({ triangle[0], triangle[1], triangle[2] });
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(triangles);
  return data;
}
} // namespace

LabelImage::Pointer
LabelsOfSurface(const TriangleSurface & surface, const itk::ImageBase<3> * grid)
{
  const auto size = grid->GetLargestPossibleRegion().GetSize();
  auto       labels = LabelImage::New();
  labels->CopyInformation(grid);
  labels->SetRegions(grid->GetLargestPossibleRegion());
  labels->Allocate(true);

  int extent[6];
  for (int d = 0; d < 3; ++d)
  {
    extent[2 * d] = 0;
    extent[2 * d + 1] = static_cast<int>(size[d]) - 1;
  }
  vtkNew<vtkPolyDataToImageStencil> stencil;
  stencil->SetInputData(ToIndexSpace(surface, grid));
  stencil->SetOutputOrigin(0.0, 0.0, 0.0);
  stencil->SetOutputSpacing(1.0, 1.0, 1.0);
  stencil->SetOutputWholeExtent(extent);
  stencil->Update();
  vtkImageStencilData * inside = stencil->GetOutput();
  for (int z = 0; z <= extent[5]; ++z)
  {
    for (int y = 0; y <= extent[3]; ++y)
    {
      short * row =
        labels->GetBufferPointer() + (static_cast<std::size_t>(z) * size[1] + static_cast<std::size_t>(y)) * size[0];
      int first = 0;
      int last = 0;
      for (int iterator = 0; inside->GetNextExtent(first, last, 0, extent[1], y, z, iterator) != 0;)
      {
        std::fill(row + first, row + last + 1, short{ 1 });
      }
    }
  }
  return labels;
}
} // namespace bone
