/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabTiler.h"

#include <gtest/gtest.h>

namespace SlabTilerTests
{
using bone::ContourStack;
using bone::Vector3;
using namespace bone::tiling;

/** Tetrahedra with a base on z = 0 and a tip above its corner on z = 1. */
class Tetrahedra
{
public:
  void
  Add(const Vector3 & corner)
  {
    TiledTetra tetra{};
    int        k = 0;
    for (const Vector3 & x : { Vector3(0, 0, 0), Vector3(4, 0, 0), Vector3(0, 4, 0), Vector3(0, 0, 1) })
    {
      const Vector3 p = corner + x;
      tetra.vertices[k++] = m_Pool.Add(p.head<2>(), p, 0, 0);
    }
    m_Tetrahedra.push_back(tetra);
  }

  bool
  Cross(std::size_t begin = 0) const
  {
    return WallsCross(m_Pool, *ContourStack::New(), m_Tetrahedra, begin, 0.0, 1.0);
  }

private:
  VertexPool              m_Pool;
  std::vector<TiledTetra> m_Tetrahedra;
};

TEST(WallsCross, WhereTetrahedraOverlap)
{
  Tetrahedra apart;
  apart.Add({ 0, 0, 0 });
  apart.Add({ 5, 0, 0 });
  EXPECT_FALSE(apart.Cross());
  Tetrahedra overlapping;
  overlapping.Add({ 0, 0, 0 });
  overlapping.Add({ 0.5, 0.5, 0 });
  EXPECT_TRUE(overlapping.Cross());
}

TEST(WallsCross, LooksAtTheTetrahedraFromTheFirstGiven)
{
  Tetrahedra three;
  three.Add({ 0, 0, 0 });
  three.Add({ 0.5, 0.5, 0 });
  three.Add({ 9, 9, 0 });
  EXPECT_TRUE(three.Cross(0));
  EXPECT_FALSE(three.Cross(1));
}
} // namespace SlabTilerTests
