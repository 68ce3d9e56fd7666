/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshCollapser.h"

#include "../../Core/test/boneTestBodies.h"
#include "boneQualityMeasures.h"

#include <gtest/gtest.h>

using namespace bone;

namespace MeshCollapserTests
{
constexpr IdType Pit = 0;
constexpr IdType Below = 1;
constexpr int    Rim = 6;

/** A flat-topped cone, its tip `Below`, with a pit 2 mm deep in its top. */
MeshArrays
ConeWithPit()
{
  MeshArrays mesh;
  mesh.points = { { 0, 0, -2 }, { 0, 0, -6 } };
  for (int i = 0; i < Rim; ++i)
  {
    const double angle = i * std::acos(-1.0) / 3;
    mesh.points.push_back({ 4 * std::cos(angle), 4 * std::sin(angle), 0 });
    mesh.tetrahedra.push_back({ Pit, Below, 2 + i, 2 + (i + 1) % Rim });
  }
  test::MakePositive(mesh);
  return mesh;
}

/** A thin tetrahedron that comes down from above and ends in the pit, at half its depth. */
void
AddNeedle(MeshArrays & mesh)
{
  const auto p = static_cast<IdType>(mesh.points.size());
  for (const Vector3 & x : { Vector3(0, 0, -1), Vector3(0.5, 0, 1), Vector3(-0.3, 0.4, 1), Vector3(-0.3, -0.4, 1) })
  {
    mesh.points.push_back(x);
  }
  mesh.tetrahedra.push_back({ p, p + 1, p + 2, p + 3 });
  test::MakePositive(mesh);
}

std::vector<TriangleIds>
BoundaryOf(const TetraComplex & complex)
{
  std::vector<TriangleIds> faces;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; complex.IsAlive(t) && i < 4; ++i)
    {
      if (complex.Neighbors(t)[i] < 0)
      {
        const Id4 & c = complex.Cell(t);
        faces.push_back({ c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] });
      }
    }
  }
  return faces;
}

TetraCollapseParameters
WithoutBounds()
{
  TetraCollapseParameters parameters;
  parameters.maximumVolumeChange = std::numeric_limits<double>::infinity();
  parameters.minimumDihedralAngle = 0.0;
  parameters.minimumCorticalDihedralAngle = 0.0;
  return parameters;
}

std::size_t
OverlapsRefused(const MeshCollapser & collapser)
{
  return collapser.Refused()[static_cast<int>(MeshOperation::Overlap)];
}

TEST(MeshCollapser, APitIsNotFilledWhereTheBoundaryWouldPassThroughWhatStandsInIt)
{
  MeshArrays mesh = ConeWithPit();
  AddNeedle(mesh);
  MeshCollapser collapser(mesh, WithoutBounds(), Execution());
  collapser.Run(1, Execution());
  EXPECT_GT(OverlapsRefused(collapser), 0u);
  EXPECT_FALSE(collapser.Complex().Star(Pit).empty());
  EXPECT_TRUE(FindCrossingTriangles(BoundaryOf(collapser.Complex()), collapser.Complex().Points()).empty());
}

TEST(MeshCollapser, AnEmptyPitIsFilled)
{
  MeshCollapser collapser(ConeWithPit(), WithoutBounds(), Execution());
  collapser.Run(1, Execution());
  EXPECT_EQ(OverlapsRefused(collapser), 0u);
  EXPECT_TRUE(collapser.Complex().Star(Pit).empty());
}
} // namespace MeshCollapserTests
