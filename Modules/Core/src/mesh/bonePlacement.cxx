/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlacement.h"

#include "boneBernstein.h"

#include <algorithm>
#include <utility>

namespace bone
{
namespace
{
void
SwapFirstTwoVertices(MeshArrays & mesh)
{
  for (auto * ids : { &mesh.tetrahedra, &mesh.neighbors })
  {
    for (Id4 & four : *ids)
    {
      std::swap(four[0], four[1]);
    }
  }
  const auto row = static_cast<std::size_t>(BernsteinCount(std::max(mesh.maximumDegree, 0)));
  for (std::size_t t = 0; t < mesh.degree.size(); ++t)
  {
    double * const c = &mesh.coefficients[t * row];
    for (const auto & e : BernsteinExponents(mesh.degree[t]))
    {
      if (e[0] > e[1])
      {
        std::swap(c[BernsteinIndex(mesh.degree[t], e[0], e[1], e[2])],
                  c[BernsteinIndex(mesh.degree[t], e[1], e[0], e[2])]);
      }
    }
  }
}
} // namespace

bool
PointsForward(const Vector3 & direction)
{
  Vector3::Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction[largest] > 0.0;
}

bool
operator==(const Placement & a, const Placement & b)
{
  return a.direction == b.direction && a.origin == b.origin;
}

Placement
PlacementOf(const itk::ImageBase<3> & image)
{
  Placement                    placement;
  itk::ImageBase<3>::PointType first;
  image.TransformIndexToPhysicalPoint(image.GetLargestPossibleRegion().GetIndex(), first);
  for (unsigned int row = 0; row < 3; ++row)
  {
    placement.origin[row] = first[row];
    for (unsigned int column = 0; column < 3; ++column)
    {
      placement.direction(row, column) = image.GetDirection()[row][column];
    }
  }
  return placement;
}

MeshArrays
Place(MeshArrays mesh, const Placement & placement)
{
  for (Vector3 & x : mesh.points)
  {
    x = placement(x);
  }
  if (placement.IsReflection())
  {
    SwapFirstTwoVertices(mesh);
  }
  return mesh;
}

ContourStack::Pointer
Place(const ContourStack & contours, const Placement & placement)
{
  const Vector3 normal = placement.direction * contours.GetNormal();
  const bool    forward = PointsForward(normal);
  // Seen from where the normal points, once slices are in order.
  const bool                   turned = placement.IsReflection() == forward;
  ContourStack::SliceContainer slices = contours.GetSlices();
  for (ContourSlice & slice : slices)
  {
    slice.origin = placement(slice.origin);
    for (Contour & contour : slice.contours)
    {
      std::transform(contour.points.begin(), contour.points.end(), contour.points.begin(), placement);
      if (turned && !contour.axis && !contour.points.empty())
      {
        std::reverse(contour.points.begin() + 1, contour.points.end());
        std::reverse(contour.clearance.begin() + (contour.clearance.empty() ? 0 : 1), contour.clearance.end());
      }
    }
  }
  if (!forward)
  {
    std::reverse(slices.begin(), slices.end());
  }
  auto          placed = ContourStack::New();
  const Vector3 u = placement.direction * contours.GetU();
  placed->SetFrame(u, forward ? normal.cross(u) : u.cross(normal));
  placed->SetOpenStart(forward ? contours.GetOpenStart() : contours.GetOpenEnd());
  placed->SetOpenEnd(forward ? contours.GetOpenEnd() : contours.GetOpenStart());
  placed->SetSlices(std::move(slices));
  return placed;
}

DensityHierarchy<>::Pointer
Place(const DensityHierarchy<> & hierarchy, const Placement & placement)
{
  auto levels = hierarchy.GetLevels();
  for (auto & level : levels)
  {
    const auto mesh = DensityHierarchy<>::MeshType::New();
    mesh->SetArrays(Place(level.mesh->GetArrays(), placement));
    level.mesh = mesh;
  }
  auto placed = DensityHierarchy<>::New();
  placed->SetLevels(std::move(levels));
  return placed;
}
} // namespace bone
