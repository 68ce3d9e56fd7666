/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneQualityTestBodies_h
#define boneQualityTestBodies_h

#include "../../Core/test/boneTestBodies.h"
#include "boneContourStack.h"
#include "boneTetraComplex.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace bone
{
namespace test
{
/** Contours of a rod along z, every half millimetre to 22 mm; with an `inner` radius, of its second region too. */
inline ContourStack::Pointer
RodContours(double radius, double inner = 0.0)
{
  constexpr int                around = 96;
  const double                 turn = 2.0 * std::acos(-1.0) / around;
  ContourStack::SliceContainer slices;
  for (double z = 0.0; z <= 22.0; z += 0.5)
  {
    slices.emplace_back();
    slices.back().origin = Vector3(0, 0, z);
    for (const double r : { radius, inner })
    {
      Contour contour;
      contour.region = r == radius ? Region::Cortical : Region::Trabecular;
      for (int i = 0; i < around; ++i)
      {
        contour.points.push_back(Vector3(r * std::cos(i * turn), r * std::sin(i * turn), z));
      }
      if (r > 0)
      {
        slices.back().contours.push_back(contour);
      }
    }
  }
  auto stack = ContourStack::New();
  stack->SetSlices(slices);
  return stack;
}

/** A straight rod along z of two regions, 22 mm long, its points on regular rings. */
inline MeshArrays
StraightRod(double radius)
{
  TubeShape shape;
  shape.rings = { 1, 2 };
  shape.radius = radius;
  shape.bend = 0.0;
  shape.jitter = 0.0;
  return MakeTube(shape);
}

/** Mean angle (rad) between neighbouring triangles of the boundary that is not cut flat. */
inline double
MeanTurn(const TetraComplex & complex)
{
  std::map<std::pair<IdType, IdType>, std::vector<Vector3>> normals;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      const int surface = complex.Carries(t, i) ? complex.FaceSurfaces(t)[i] : -1;
      if (surface < 0 || !complex.Surfaces().surfaces[surface].IsBoundary() ||
          complex.Surfaces().surfaces[surface].flat >= 0)
      {
        continue;
      }
      IdType v[3];
      for (int k = 0; k < 3; ++k)
      {
        v[k] = complex.Cell(t)[TetraFaces[i][k]];
      }
      const auto &  x = complex.Points();
      const Vector3 normal = (x[v[1]] - x[v[0]]).cross(x[v[2]] - x[v[0]]).normalized();
      for (int k = 0; k < 3; ++k)
      {
        normals[std::minmax(v[k], v[(k + 1) % 3])].push_back(normal);
      }
    }
  }
  double sum = 0.0;
  int    count = 0;
  for (const auto & edge : normals)
  {
    if (edge.second.size() == 2)
    {
      sum += std::atan2(edge.second[0].cross(edge.second[1]).norm(), edge.second[0].dot(edge.second[1]));
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}
} // namespace test
} // namespace bone

#endif
