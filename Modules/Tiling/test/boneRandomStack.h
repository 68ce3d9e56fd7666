/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRandomStack_h
#define boneRandomStack_h

#include "boneContourStack.h"

#include <cmath>
#include <map>
#include <random>

namespace bone
{
/** A random body of blobs and tunnels on slices: contours split and merge, holes open and close, layers come and go.
 * Layers are higher levels of one field, so that contours are nested. */
class RandomStack
{
public:
  explicit RandomStack(unsigned seed)
    : m_Engine(seed)
  {
    const int blobs = 3 + static_cast<int>(Uniform(0, 6));
    for (int i = 0; i < blobs; ++i)
    {
      m_Blobs.push_back({ Place(), Uniform(5, 11), Uniform(0.8, 1.5) });
    }
    const int tunnels = static_cast<int>(Uniform(0, 3));
    for (int i = 0; i < tunnels; ++i)
    {
      m_Blobs.push_back({ Place(), Uniform(2, 4), Uniform(-3, -1.5) });
    }
    m_Step = Uniform(1.5, 3.5);
    m_Cell = Uniform(1.0, 2.2);
  }

  ContourStack::Pointer
  Make()
  {
    constexpr double             Levels[] = { 0.5, 0.75, 1.1 };
    ContourStack::SliceContainer slices;
    for (double z = -Extent; z <= Extent; z += m_Step)
    {
      ContourSlice slice;
      slice.origin = Vector3(0, 0, z);
      for (int layer = 0; layer < 3; ++layer)
      {
        AddLevel(z, Levels[layer], layer, slice);
      }
      slices.push_back(slice);
    }
    auto stack = ContourStack::New();
    stack->SetSlices(slices);
    return stack;
  }

private:
  static constexpr double Extent = 22.0;

  struct Blob
  {
    Vector3 centre;
    double  radius, weight;
  };

  double
  Uniform(double low, double high)
  {
    return low + (high - low) * static_cast<double>(m_Engine()) / 4294967296.0;
  }

  Vector3
  Place()
  {
    const double x = Uniform(-9, 9), y = Uniform(-9, 9), z = Uniform(-12, 12);
    return { x, y, z };
  }

  double
  Field(double x, double y, double z) const
  {
    double sum = 0.0;
    for (const Blob & blob : m_Blobs)
    {
      sum += blob.weight * std::exp(-(Vector3(x, y, z) - blob.centre).squaredNorm() / (blob.radius * blob.radius));
    }
    return sum;
  }

  /** Marching squares with the higher side on the left; holes are kept in the outermost level only, so that a layer
   * round a hole begins at it. */
  void
  AddLevel(double z, double level, int layer, ContourSlice & slice) const
  {
    const int           n = static_cast<int>(2 * Extent / m_Cell);
    std::vector<double> value((n + 1) * (n + 1));
    const auto          at = [&](int i, int j) -> double & { return value[j * (n + 1) + i]; };
    for (int j = 0; j <= n; ++j)
    {
      for (int i = 0; i <= n; ++i)
      {
        const bool rim = i == 0 || j == 0 || i == n || j == n;
        at(i, j) = rim ? -1.0 : Field(-Extent + i * m_Cell, -Extent + j * m_Cell, z) - level;
      }
    }
    // Crossed edges as (i, j, direction) -> the next one.
    using Edge = std::array<int, 3>;
    std::map<Edge, Edge> next;
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        const double corner[] = { at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1) };
        const Edge   edges[] = { { i, j, 0 }, { i + 1, j, 1 }, { i, j + 1, 0 }, { i, j, 1 } };
        for (int k = 0; k < 4; ++k)
        {
          // In where the sign falls, counter-clockwise, out where it rises again: the higher side lies on the left.
          if (corner[k] < 0 || corner[(k + 1) % 4] >= 0)
          {
            continue;
          }
          int out = (k + 1) % 4;
          while (!(corner[out] < 0 && corner[(out + 1) % 4] >= 0))
          {
            out = (out + 1) % 4;
          }
          next[edges[k]] = edges[out];
        }
      }
    }
    while (!next.empty())
    {
      Contour contour;
      Edge    edge = next.begin()->first;
      for (auto it = next.find(edge); it != next.end(); it = next.find(edge))
      {
        const double a = at(edge[0], edge[1]), b = at(edge[0] + (edge[2] == 0), edge[1] + (edge[2] == 1));
        const double t = std::clamp(a / (a - b), 0.1, 0.9) * m_Cell;
        contour.points.emplace_back(
          -Extent + edge[0] * m_Cell + (edge[2] == 0 ? t : 0), -Extent + edge[1] * m_Cell + (edge[2] == 1 ? t : 0), z);
        edge = it->second;
        next.erase(it);
      }
      std::vector<Vector2> polygon;
      for (const Vector3 & p : contour.points)
      {
        polygon.emplace_back(p.x(), p.y());
      }
      const bool hole = SignedArea(polygon) < 0;
      if (polygon.size() < 4)
      {
        continue;
      }
      contour.layer = hole ? std::max(0, layer - 1) : layer;
      contour.region = hole ? layer : layer + 1;
      contour.id = static_cast<int>(slice.contours.size());
      slice.contours.push_back(contour);
    }
  }

  std::mt19937      m_Engine;
  std::vector<Blob> m_Blobs;
  double            m_Step, m_Cell;
};
} // namespace bone

#endif
