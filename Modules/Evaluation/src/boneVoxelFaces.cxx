/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVoxelFaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
VoxelFaces::VoxelFaces(const LabelImage * mask)
  : m_Place(PlacementOf(*mask))
  , m_ToGrid(m_Place.Inverse())
{
  const auto region = mask->GetLargestPossibleRegion();
  for (unsigned int d = 0; d < 3; ++d)
  {
    m_Spacing[d] = mask->GetSpacing()[d];
    m_Size[d] = static_cast<long>(region.GetSize(d)) + 1;
  }
  m_Faces.resize(static_cast<std::size_t>(m_Size[0] * m_Size[1] * m_Size[2]), 0);
  const std::array<long, 3> stride{ { 1, m_Size[0], m_Size[0] * m_Size[1] } };
  const short *             voxel = mask->GetBufferPointer();
  for (long z = 1; z < m_Size[2]; ++z)
  {
    for (long y = 1; y < m_Size[1]; ++y)
    {
      for (long x = 1; x < m_Size[0]; ++x, ++voxel)
      {
        if (*voxel == 0)
        {
          continue;
        }
        m_IsEmpty = false;
        // Each voxel inside turns its six faces: what is turned twice lies between two of them.
        const long k = x + y * stride[1] + z * stride[2];
        for (unsigned int d = 0; d < 3; ++d)
        {
          const auto bit = static_cast<unsigned char>(1U << d);
          m_Faces[static_cast<std::size_t>(k)] ^= bit;
          m_Faces[static_cast<std::size_t>(k - stride[d])] ^= bit;
        }
      }
    }
  }
}

double
VoxelFaces::SquaredDistanceInCell(const Vector3 & q, const Cell & cell, unsigned char faces) const
{
  // From the middle of the cell; cell 1 is the image's first voxel.
  Vector3 off, beyond;
  for (unsigned int d = 0; d < 3; ++d)
  {
    off[d] = q[d] - static_cast<double>(cell[d] - 1) * m_Spacing[d];
    beyond[d] = std::max(0.0, std::abs(off[d]) - 0.5 * m_Spacing[d]);
  }
  double least = std::numeric_limits<double>::infinity();
  for (unsigned int d = 0; d < 3; ++d)
  {
    if ((faces & (1U << d)) != 0)
    {
      Vector3 to = beyond;
      to[d] = off[d] - 0.5 * m_Spacing[d];
      least = std::min(least, to.squaredNorm());
    }
  }
  return least;
}

double
VoxelFaces::Distance(const Vector3 & x) const
{
  double least = std::numeric_limits<double>::infinity();
  if (m_IsEmpty)
  {
    return least;
  }
  const Vector3 q = m_ToGrid(x);
  Cell          middle{};
  long          farthest = 0;
  for (unsigned int d = 0; d < 3; ++d)
  {
    middle[d] = std::lround(q[d] / m_Spacing[d]) + 1;
    farthest = std::max({ farthest, middle[d], m_Size[d] - 1 - middle[d] });
  }
  const double smallest = m_Spacing.minCoeff();
  for (long r = 0; r <= farthest; ++r)
  {
    // Cells farther out than the shell before are at least so far away.
    const double reached = smallest * static_cast<double>(r - 1);
    if (r > 0 && least <= reached * reached)
    {
      break;
    }
    for (long z = std::max(0L, middle[2] - r); z <= std::min(m_Size[2] - 1, middle[2] + r); ++z)
    {
      for (long y = std::max(0L, middle[1] - r); y <= std::min(m_Size[1] - 1, middle[1] + r); ++y)
      {
        const bool side = std::abs(z - middle[2]) == r || std::abs(y - middle[1]) == r;
        for (long i = -r; i <= r; i += side || r == 0 ? 1 : 2 * r)
        {
          const long n = middle[0] + i;
          if (n < 0 || n >= m_Size[0])
          {
            continue;
          }
          const unsigned char faces = m_Faces[static_cast<std::size_t>((z * m_Size[1] + y) * m_Size[0] + n)];
          if (faces != 0)
          {
            least = std::min(least, this->SquaredDistanceInCell(q, { { n, y, z } }, faces));
          }
        }
      }
    }
  }
  return std::sqrt(least);
}

std::vector<Vector3>
VoxelFaces::GetCentres() const
{
  std::vector<Vector3> centres;
  std::size_t          k = 0;
  for (long z = 0; z < m_Size[2]; ++z)
  {
    for (long y = 0; y < m_Size[1]; ++y)
    {
      for (long x = 0; x < m_Size[0]; ++x, ++k)
      {
        for (unsigned int d = 0; d < 3 && m_Faces[k] != 0; ++d)
        {
          if ((m_Faces[k] & (1U << d)) != 0)
          {
            Vector3 index(static_cast<double>(x - 1), static_cast<double>(y - 1), static_cast<double>(z - 1));
            index[d] += 0.5;
            centres.push_back(m_Place(index.cwiseProduct(m_Spacing)));
          }
        }
      }
    }
  }
  return centres;
}
} // namespace bone
