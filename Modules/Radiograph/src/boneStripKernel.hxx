/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Cells of many pixels or of high degree. It is compiled like boneProjectionKernel.hxx, which describes a cell's frame.
//
// A cell is filled by strips of eight columns: a lane keeps its column from row to row, so that the polynomial is
// reduced to one in (eta, z) a lane once a strip, and a row takes some forty instructions without branches. What a row
// of a strip has beside the cell costs nothing but lanes.

#include "boneTileKernel.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** One cell as its strips need it. */
struct StripCell
{
  double c0, r0;
  float  kappa;
  Group  depth[3];          ///< of its planes, as in Frames, fronts first
  int    fronts;            ///< how many of the planes are
  double column[4], row[4]; ///< of the vertices
};

inline Tile
Columns()
{
  Tile index;
  for (int i = 0; i < tileRows * lanes; ++i)
  {
    index[i] = static_cast<float>(i % lanes);
  }
  return index;
}
inline Tile
Rows()
{
  Tile index;
  for (int i = 0; i < tileRows * lanes; ++i)
  {
    index[i] = static_cast<float>(i / lanes);
  }
  return index;
}

inline void
AccumulateTile(float * out, std::ptrdiff_t stride, const Tile & value)
{
  if constexpr (tileRows == 1)
  {
    Accumulate(out, __builtin_shufflevector(value, value, 0, 1, 2, 3, 4, 5, 6, 7));
  }
  else
  {
    Accumulate(out, __builtin_shufflevector(value, value, 0, 1, 2, 3, 4, 5, 6, 7));
    Accumulate(out + stride, __builtin_shufflevector(value, value, 8, 9, 10, 11, 12, 13, 14, 15));
  }
}

/** Rows [firstRow, endRow) of the eight columns from `column`; rows of the last tile beyond are written, too.
 * `densities` points to the cell's lane of the coefficients, which are `lanes` apart; xi and eta count pixels. */
template <int N, int TFronts>
inline void
AddStrip(const StripCell & cell,
         const float *     densities,
         int               column,
         int               firstRow,
         int               endRow,
         float *           out,
         std::ptrdiff_t    stride)
{
  typedef float Planes __attribute__((vector_size(4 * sizeof(float))));
  const Tile    index = Columns(), rows = Rows(), zero{};
  const double  dc = column - cell.c0, dr = firstRow - cell.r0;
  const Tile    xi = index + static_cast<float>(dc);
  // Density of the lane's column: coefficients of eta^b z^k.
  Tile inEta[N + 1][N + 1];
  for (int k = 0; k <= N; ++k)
  {
    for (int b = 0; b <= N; ++b)
    {
      const float * const from = densities + (b * (N + 1) * (N + 1) + k * (N + 1)) * lanes;
      Tile                value = from[(N - b) * lanes] - zero;
      for (int a = N - b - 1; a >= 0; --a)
      {
        value = value * xi + from[a * lanes];
      }
      inEta[k][b] = value;
    }
  }
  const Planes perColumn = __builtin_convertvector(cell.depth[1], Planes);
  const Planes perRow = __builtin_convertvector(cell.depth[2], Planes);
  float        columnSteps[4], rowSteps[4];
  __builtin_memcpy(columnSteps, &perColumn, sizeof(columnSteps));
  __builtin_memcpy(rowSteps, &perRow, sizeof(rowSteps));
  Tile along[4];
  for (int i = 0; i < 4; ++i)
  {
    along[i] = columnSteps[i] * index + rowSteps[i] * rows;
  }
  Group       start = cell.depth[0] + cell.depth[1] * dc + cell.depth[2] * dr;
  const Group step = tileRows * cell.depth[2];
  Tile        eta = rows + static_cast<float>(dr);
  for (int row = firstRow; row < endRow; row += tileRows)
  {
    float        at[4];
    const Planes rounded = __builtin_convertvector(start, Planes);
    __builtin_memcpy(at, &rounded, sizeof(at));
    // Broadcast from memory: to permute them out of registers takes longer.
    __asm__ volatile("" : "+m"(at));
    Tile entry = along[0] + at[0];
    for (int i = 1; i < TFronts; ++i)
    {
      const Tile depth = along[i] + at[i];
      entry = depth < entry ? depth : entry;
    }
    Tile exit = along[TFronts] + at[TFronts];
    for (int i = TFronts + 1; i < 4; ++i)
    {
      const Tile depth = along[i] + at[i];
      exit = depth > exit ? depth : exit;
    }
    const Chord chord(entry, exit, cell.kappa);
    Tile        inZ[N + 1];
    for (int k = 0; k <= N; ++k)
    {
      inZ[k] = inEta[k][N];
      for (int power = N - 1; power >= 0; --power)
      {
        inZ[k] = inZ[k] * eta + inEta[k][power];
      }
    }
    const Tile value = chord.length * Mean<N>(inZ, chord.middle, chord.length);
    AccumulateTile(out, stride, entry > exit ? value : zero);
    out += tileRows * stride;
    start += step;
    eta += tileRows;
  }
}

/** The rows of each strip of a cell that may be hit. */
struct StripRows
{
  float low[lanes], high[lanes]; ///< less r0
};

/** Of strips that begin at `first`: where the hull of the vertices meets the strips' borders, and the vertices within.
 */
inline void
SetStripRows(const StripCell & cell, int first, StripRows & rows)
{
  float x[4], y[4];
  for (int i = 0; i < 4; ++i)
  {
    x[i] = static_cast<float>(cell.column[i] - (first - 0.5));
    y[i] = static_cast<float>(cell.row[i] - cell.r0);
  }
  const Batch x1 = { x[0], x[0], x[0], x[1], x[1], x[2], 0, 0 }, x2 = { x[1], x[2], x[3], x[2], x[3], x[3], 1, 1 };
  const Batch y1 = { y[0], y[0], y[0], y[1], y[1], y[2], 0, 0 }, y2 = { y[1], y[2], y[3], y[2], y[3], y[3], 0, 0 };
  const Batch slope = (y2 - y1) / (x2 - x1);
  const Batch none{}, large = none + 1e9f;
  const Batch border = { 0, lanes, 2 * lanes, 3 * lanes, 4 * lanes, 5 * lanes, 6 * lanes, 7 * lanes };
  Batch       low = large, high = -large;
  for (int e = 0; e < 6; ++e)
  {
    const Batch from = border - x1[e];
    const Batch at = y1[e] + from * slope[e];
    const auto  met = from * (border - x2[e]) <= 0;
    low = met & (at < low) ? at : low;
    high = met & (at > high) ? at : high;
  }
  const Batch nextLow = __builtin_shufflevector(low, large, 1, 2, 3, 4, 5, 6, 7, 8);
  const Batch nextHigh = __builtin_shufflevector(high, -large, 1, 2, 3, 4, 5, 6, 7, 8);
  low = nextLow < low ? nextLow : low;
  high = nextHigh > high ? nextHigh : high;
  for (int i = 0; i < 4; ++i)
  {
    const Batch from = x[i] - border;
    const auto  within = (from >= 0) & (from <= float(lanes));
    low = within & (y[i] < low) ? none + y[i] : low;
    high = within & (y[i] > high) ? none + y[i] : high;
  }
  __builtin_memcpy(rows.low, &low, sizeof(low));
  __builtin_memcpy(rows.high, &high, sizeof(high));
}

template <int N, int TFronts>
void
AddStrips(const StripCell & cell, const float * densities, const PixelBox & box, const Band & band)
{
  constexpr float margin = 0.01f;
  constexpr int   stripsAtOnce = lanes - 1; // as many as have two borders
  StripRows       rows;
  int             strip = stripsAtOnce;
  for (int column = box.firstColumn; column < box.endColumn; column += lanes, ++strip)
  {
    if (strip == stripsAtOnce)
    {
      SetStripRows(cell, column, rows);
      strip = 0;
    }
    const int low = -Floor(margin - rows.low[strip] - cell.r0), high = Floor(rows.high[strip] + margin + cell.r0) + 1;
    const int first = low > box.firstRow ? low : box.firstRow, end = high < box.endRow ? high : box.endRow;
    if (first < end)
    {
      float * const out = band.data + (first - band.firstRow) * band.stride + column - band.firstColumn;
      AddStrip<N, TFronts>(cell, densities, column, first, end, out, band.stride);
    }
  }
}

/** A cell of any size. */
template <int N>
void
AddStrips(const StripCell & cell, const float * densities, const PixelBox & box, const Band & band)
{
  switch (cell.fronts)
  {
    case 1:
      AddStrips<N, 1>(cell, densities, box, band);
      break;
    case 2:
      AddStrips<N, 2>(cell, densities, box, band);
      break;
    case 3:
      AddStrips<N, 3>(cell, densities, box, band);
      break;
    default:
      break; // there is a front and a back
  }
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
