/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// What spans and strips have in common, compiled like boneProjectionKernel.hxx.

#ifndef boneTileKernel_hxx
#define boneTileKernel_hxx

#ifndef BONE_PROJECTION_TILE_ROWS
#error "BONE_PROJECTION_TILE_ROWS says how many rows of eight pixels a vector holds."
#endif

#include "boneProjectionKernel.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** The pixels of a cell's bounding box. */
struct PixelBox
{
  int firstColumn, endColumn;
  int firstRow, endRow;

  int
  Pixels() const
  {
    return (endColumn - firstColumn) * (endRow - firstRow);
  }
};

/** Rows that are computed at once, and a lane for each of their pixels. */
constexpr int          tileRows = BONE_PROJECTION_TILE_ROWS;
constexpr int          tileLanes = tileRows * lanes;
typedef float          Tile __attribute__((vector_size(tileLanes * sizeof(float))));
typedef int            TileIndex __attribute__((vector_size(tileLanes * sizeof(int))));
typedef unsigned short TilePlaces __attribute__((vector_size(tileLanes * sizeof(unsigned short))));
typedef int            BatchIndex __attribute__((vector_size(lanes * sizeof(int))));

template <typename TVector, typename TValue>
inline TVector
LoadVector(const TValue * from)
{
  TVector value;
  __builtin_memcpy(&value, from, sizeof(value));
  return value;
}

template <typename TVector, typename TValue>
inline void
StoreVector(TValue * to, const TVector & value)
{
  __builtin_memcpy(to, &value, sizeof(value));
}

/** Rows of eight become columns. */
inline void
TransposeBlock(const Batch (&from)[lanes], Batch (&to)[lanes])
{
  Batch low[lanes], high[lanes];
  Transpose(reinterpret_cast<const Batch(&)[groupSize]>(from[0]), low);
  Transpose(reinterpret_cast<const Batch(&)[groupSize]>(from[groupSize]), high);
  // Of low: column k in its first half, column k + 4 in its second, of rows 0..3; high: of rows 4..7.
  for (int k = 0; k < groupSize; ++k)
  {
    to[k] = __builtin_shufflevector(low[k], high[k], 0, 1, 2, 3, 8, 9, 10, 11);
    to[k + groupSize] = __builtin_shufflevector(low[k], high[k], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

/** Mean of the polynomial in z over [middle - length / 2, middle + length / 2]. */
template <int N>
inline Tile
Mean(const Tile (&inZ)[N + 1], const Tile & middle, const Tile & length)
{
  if constexpr (N == 0)
  {
    return inZ[0];
  }
  else if constexpr (N == 1)
  {
    return inZ[0] + inZ[1] * middle;
  }
  else if constexpr (N == 2)
  {
    return inZ[0] + middle * (inZ[1] + middle * inZ[2]) + (length * length) * (inZ[2] * (1.0f / 12));
  }
  else if constexpr (N == 3)
  {
    const Tile third = inZ[3] * middle, second = inZ[2] + third;
    return inZ[0] + middle * (inZ[1] + middle * second) + (length * length) * ((second + 2 * third) * (1.0f / 12));
  }
  else
  {
    constexpr int points = N / 2 + 1;
    Tile          mean{};
    for (int g = 0; g < points; ++g)
    {
      const Tile z = middle + static_cast<float>(0.5 * Gauss<points>::x[g]) * length;
      Tile       value = inZ[N];
      for (int k = N - 1; k >= 0; --k)
      {
        value = value * z + inZ[k];
      }
      mean += static_cast<float>(Gauss<points>::w[g]) * value;
    }
    return mean;
  }
}

/** Entry into a cell and exit from it, in v, as the middle and the length of the way between in z. */
struct Chord
{
  Tile middle, length;

  Chord(const Tile & entry, const Tile & exit, float kappa)
  {
    const Tile a = 1 + kappa * entry, b = 1 + kappa * exit;
    const Tile inverse = 1 / (a * b);
    length = (entry - exit) * inverse;
    middle = 0.5f * length - entry * (b * inverse);
  }
};
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone

#endif
