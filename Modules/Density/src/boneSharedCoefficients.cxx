/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSharedCoefficients.h"

#include "boneBernstein.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
/** A vertex, edge or face of a region: its point ids ascending, -1 where there are fewer than three. */
struct Simplex
{
  int                   region;
  std::array<IdType, 3> points;

  bool
  operator<(const Simplex & other) const
  {
    return region != other.region ? region < other.region : points < other.points;
  }
  bool
  operator==(const Simplex & other) const
  {
    return region == other.region && points == other.points;
  }
};

/** The vertices of a tetrahedron whose exponents are not 0, sorted by point id, with those exponents. */
struct Support
{
  std::array<IdType, 4> points{ { -1, -1, -1, -1 } };
  std::array<int, 4>    exponents{ { 0, 0, 0, 0 } };
  int                   size{ 0 };
};

Support
SupportOf(const Id4 & tetra, const std::array<int, 4> & exponents)
{
  Support support;
  for (int i = 0; i < 4; ++i)
  {
    if (exponents[i] == 0)
    {
      continue;
    }
    int at = support.size++;
    for (; at > 0 && support.points[at - 1] > tetra[i]; --at)
    {
      support.points[at] = support.points[at - 1];
      support.exponents[at] = support.exponents[at - 1];
    }
    support.points[at] = tetra[i];
    support.exponents[at] = exponents[i];
  }
  return support;
}

/** Place of a coefficient among those inside its vertex, edge or face. */
std::size_t
PlaceWithin(const Support & support)
{
  switch (support.size)
  {
    case 2:
      return support.exponents[1] - 1;
    case 3:
    {
      const int r = support.exponents[1] + support.exponents[2] - 2;
      return static_cast<std::size_t>(r) * (r + 1) / 2 + support.exponents[2] - 1;
    }
    default:
      return 0;
  }
}

std::vector<Simplex>
SimplicesOf(const MeshArrays & mesh)
{
  constexpr std::array<int, 14> masks = { { 1, 2, 4, 8, 3, 5, 9, 6, 10, 12, 7, 11, 13, 14 } };
  std::vector<Simplex>          simplices;
  simplices.reserve(masks.size() * mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int mask : masks)
    {
      const Support s =
        SupportOf(mesh.tetrahedra[t], { { mask & 1, (mask >> 1) & 1, (mask >> 2) & 1, (mask >> 3) & 1 } });
      simplices.push_back({ mesh.region.empty() ? 0 : mesh.region[t], { { s.points[0], s.points[1], s.points[2] } } });
    }
  }
  std::sort(simplices.begin(), simplices.end());
  simplices.erase(std::unique(simplices.begin(), simplices.end()), simplices.end());
  return simplices;
}

} // namespace

void
SharedCoefficients::ListUses()
{
  start.assign(size + 1, 0);
  for (std::uint32_t place : global)
  {
    ++start[place + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  uses.resize(global.size());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::size_t use = 0; use < global.size(); ++use)
  {
    uses[next[global[use]]++] = static_cast<std::uint32_t>(use);
  }
}

SharedCoefficients
ShareCoefficients(const MeshArrays & mesh, int degree)
{
  const int         n = degree;
  const auto &      exponents = BernsteinExponents(n);
  const std::size_t count = exponents.size(), cells = mesh.tetrahedra.size();
  if (cells > std::numeric_limits<std::uint32_t>::max() / count)
  {
    throw std::length_error("The mesh is too large for a continuous density of degree " + std::to_string(n) + ".");
  }
  const std::vector<Simplex> simplices = SimplicesOf(mesh);
  // The first coefficient of each vertex, edge and face; those inside tetrahedra follow.
  std::vector<std::size_t> first(simplices.size() + 1, 0);
  for (std::size_t s = 0; s < simplices.size(); ++s)
  {
    const auto & p = simplices[s].points;
    const int    inside = p[1] < 0 ? 1 : p[2] < 0 ? n - 1 : (n - 1) * (n - 2) / 2;
    first[s + 1] = first[s] + inside;
  }
  SharedCoefficients shared;
  shared.size = first.back();
  shared.global.resize(cells * count);
  for (std::size_t t = 0; t < cells; ++t)
  {
    std::array<std::ptrdiff_t, 16> simplexOf;
    simplexOf.fill(-1);
    for (std::size_t c = 0; c < count; ++c)
    {
      const Support support = SupportOf(mesh.tetrahedra[t], exponents[c]);
      std::size_t   place;
      if (support.size == 4)
      {
        place = shared.size++;
      }
      else
      {
        int mask = 0;
        for (int i = 0; i < 4; ++i)
        {
          mask |= exponents[c][i] > 0 ? 1 << i : 0;
        }
        if (simplexOf[mask] < 0)
        {
          const Simplex key = { mesh.region.empty() ? 0 : mesh.region[t],
                                { { support.points[0], support.points[1], support.points[2] } } };
          simplexOf[mask] = std::lower_bound(simplices.begin(), simplices.end(), key) - simplices.begin();
        }
        place = first[simplexOf[mask]] + PlaceWithin(support);
      }
      shared.global[t * count + c] = static_cast<std::uint32_t>(place);
    }
  }
  shared.ListUses();
  return shared;
}
} // namespace bone
