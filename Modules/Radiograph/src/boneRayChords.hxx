/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// What the kernels of derivatives know of the rays in a list of spans. It is compiled like boneProjectionKernel.hxx,
// which describes a cell's frame.

#ifndef boneRayChords_hxx
#define boneRayChords_hxx

#include "boneBlockSetup.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** The rays of a list of spans in their cells; all is 0, and planes are -1, where a ray misses its cell. */
struct RayChords
{
  static constexpr int capacity = SpanList::pixelCapacity / tileLanes;

  Tile      column[capacity], row[capacity]; ///< less c0 and r0
  Tile      z[capacity], half[capacity];     ///< the chord's middle, and half its length
  TileIndex entry[capacity], exit[capacity]; ///< the planes, in the order of BlockShape
};

/** Of the rays that meet their cell and, where `TWeighted`, have a weight. */
template <bool TWeighted>
inline void
SetRayChords(const BlockShape & shape, const SpanList & list, const float * weights, RayChords & chords)
{
  const Tile      zero{};
  const TileIndex none{};
  for (int i = 0; i < list.pixels; i += tileLanes)
  {
    const int           tile = i / tileLanes, g = list.cellOf[tile];
    const float * const plane = reinterpret_cast<const float *>(shape.depth) + g;
    const TileIndex     place = __builtin_convertvector(LoadVector<TilePlaces>(list.place + i), TileIndex);
    const Tile          c = __builtin_convertvector(place & 255, Tile) + list.column[g];
    const Tile          r = __builtin_convertvector(place >> 8, Tile) + list.row[g];
    const auto          at = [&](int p) __attribute__((always_inline))
    {
      const float * const of = plane + 3 * p * lanes;
      return of[0] + of[lanes] * c + of[2 * lanes] * r;
    };
    Tile       entry = at(0), exit = at(3);
    TileIndex  in = none, out = none + 3;
    const auto meet = [&](int p) __attribute__((always_inline))
    {
      const Tile depth = at(p), front = depth + shape.noFront[p - 1][g], back = depth + shape.noBack[p - 1][g];
      in = front < entry ? none + p : in;
      entry = front < entry ? front : entry;
      out = back > exit ? none + p : out;
      exit = back > exit ? back : exit;
    };
    meet(1);
    meet(2);
    const Chord chord(entry, exit, shape.kappa[g]);
    TileIndex   hit = entry > exit;
    if constexpr (TWeighted)
    {
      hit &= LoadVector<Tile>(weights + i) != 0;
    }
    chords.column[tile] = hit ? c : zero;
    chords.row[tile] = hit ? r : zero;
    chords.z[tile] = hit ? chord.middle : zero;
    chords.half[tile] = hit ? 0.5f * chord.length : zero;
    chords.entry[tile] = hit ? in : none - 1;
    chords.exit[tile] = hit ? out : none - 1;
  }
}

/** A block's barycentric coordinates, at the centroid, per column and row there, and per z. */
struct BlockCoordinates
{
  Batch mu[4][4];

  explicit BlockCoordinates(const Frames<Octet> & frames)
  {
    for (int i = 0; i < 4; ++i)
    {
      mu[0][i] = Narrow(frames.mu[0][i]);
      mu[1][i] = Narrow(frames.mu[1][i] * frames.perWidth);
      mu[2][i] = Narrow(frames.mu[2][i] * frames.perHeight);
      mu[3][i] = Narrow(frames.mu[3][i]);
    }
  }
};

/** What of a polynomial has at least X^A Y^B z^K, divided by these; `q` points to a lane of Monomials. */
template <int N, int A = 0, int B = 0, int K = 0>
inline __attribute__((always_inline)) Tile
ValueAt(const float * q, const Tile & x, const Tile & y, const Tile & z)
{
  Tile value = Tile{} + q[((A * (N + 1) + B) * (N + 1) + K) * lanes];
  if constexpr (A + B + K < N)
  {
    value += z * ValueAt<N, A, B, K + 1>(q, x, y, z);
    if constexpr (K == 0)
    {
      value += y * ValueAt<N, A, B + 1, 0>(q, x, y, z);
    }
    if constexpr (B == 0 && K == 0)
    {
      value += x * ValueAt<N, A + 1, 0, 0>(q, x, y, z);
    }
  }
  return value;
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone

#endif
