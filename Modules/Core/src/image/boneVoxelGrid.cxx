/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVoxelGrid.h"

namespace bone
{
VoxelGrid
MakeVoxelGrid(const itk::ImageBase<3> & image, const itk::ImageRegion<3> & region)
{
  VoxelGrid             grid;
  itk::Point<double, 3> origin;
  image.TransformIndexToPhysicalPoint(region.GetIndex(), origin);
  for (int row = 0; row < 3; ++row)
  {
    grid.size[row] = static_cast<int>(region.GetSize(row));
    grid.origin[row] = origin[row];
    for (int column = 0; column < 3; ++column)
    {
      grid.axes(row, column) = image.GetDirection()[row][column] * image.GetSpacing()[column];
    }
  }
  return grid;
}
} // namespace bone
