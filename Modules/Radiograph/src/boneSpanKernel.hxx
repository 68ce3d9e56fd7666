/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Cells of few pixels, compiled like boneProjectionKernel.hxx, which see for the cell's frame.
//
// Most cells of a bone cover some forty pixels, in rows of four or five: too few to fill lanes that lie side by side in
// the image. So the pixels of a cell are listed row after row (spans), computed from the list, and added to the image
// row by row. Each of these steps is done for a block of cells before the next begins, so that what is read was written
// long enough ago. Always inlined: called, GCC 12 takes SetRows for a function without effects and leaves the call out.

#include "boneTileKernel.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** Of higher degrees a polynomial reduced to the column, as in strips, costs less than one at each pixel. */
constexpr int maximumSpanDegree = 3;

/** Cells whose bounding box has more pixels, or more rows or columns than a byte counts, take strips. */
constexpr int maximumSpanBox = 384;
constexpr int maximumSpanSide = 256;

inline bool
FitsSpans(const PixelBox & box)
{
  return box.Pixels() <= maximumSpanBox && box.endRow - box.firstRow <= maximumSpanSide &&
         box.endColumn - box.firstColumn <= maximumSpanSide;
}

/** What the spans of a block need of its cells' frames. */
struct BlockShape
{
  static constexpr int limits = 4;

  Batch      depth[4][3];                     ///< of the face planes, fronts first: at the centre, per column, per row
  BatchIndex fronts;                          ///< how many of them are
  Batch      low[limits][2], high[limits][2]; ///< column limits less c0: at r0, per row; far away where there is none
  Batch      perWidth, perHeight, kappa;
};

/** Puts fronts before backs. */
inline void
SortPlanes(BlockShape & shape, BatchIndex (&front)[4])
{
  constexpr int steps[5][2] = { { 0, 1 }, { 2, 3 }, { 0, 2 }, { 1, 3 }, { 1, 2 } };
  for (const auto & step : steps)
  {
    const int        i = step[0], j = step[1];
    const BatchIndex swapped = ~front[i] & front[j];
    front[i] |= swapped;
    front[j] &= ~swapped;
    for (int k = 0; k < 3; ++k)
    {
      const Batch a = shape.depth[i][k], b = shape.depth[j][k];
      shape.depth[i][k] = swapped ? b : a;
      shape.depth[j][k] = swapped ? a : b;
    }
  }
}

/** Sets one of the limits where a front and a back plane, `front` and `back`, meet. */
inline void
SetLimit(const Batch (&front)[3], const Batch (&back)[3], int limit, BlockShape & shape)
{
  const Batch      none{}, far = none + 1e6f;
  const Batch      inverse = -1.0f / (front[1] - back[1]);
  const Batch      at = (front[0] - back[0]) * inverse, perRow = (front[2] - back[2]) * inverse;
  const BatchIndex met = (Absolute(at) < far) & (Absolute(perRow) < far);
  const BatchIndex left = met & (inverse < 0), right = met & (inverse > 0);
  shape.low[limit][0] = left ? at : -far;
  shape.low[limit][1] = left ? perRow : none;
  shape.high[limit][0] = right ? at : far;
  shape.high[limit][1] = right ? perRow : none;
}

/** The planes and the limits where they meet: three of them with one or three fronts, four with two. */
inline void
SetShape(const Frames<Octet> & frames, BlockShape & shape)
{
  shape.perWidth = Narrow(frames.perWidth);
  shape.perHeight = Narrow(frames.perHeight);
  shape.kappa = Narrow(frames.kappa);
  BatchIndex front[4];
  shape.fronts = BatchIndex{};
  for (int i = 0; i < 4; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      shape.depth[i][k] = Narrow(frames.depth[i][k]);
    }
    front[i] = Narrow(frames.slope[i]) < 0;
    shape.fronts -= front[i];
  }
  SortPlanes(shape, front);
  const auto &     depth = shape.depth;
  const BatchIndex one = shape.fronts == 1, three = shape.fronts == 3;
  Batch            firstFront[3], firstBack[3], secondFront[3], secondBack[3], lastFront[3], lastBack[3];
  for (int k = 0; k < 3; ++k)
  {
    firstFront[k] = three ? depth[2][k] : depth[0][k];
    firstBack[k] = three ? depth[3][k] : depth[2][k];
    secondFront[k] = one ? depth[0][k] : depth[1][k];
    secondBack[k] = one ? depth[1][k] : depth[3][k];
    lastFront[k] = one | three ? depth[0][k] : depth[1][k];
    lastBack[k] = one | three ? depth[3][k] : depth[2][k];
  }
  SetLimit(depth[0], depth[3], 0, shape);
  SetLimit(firstFront, firstBack, 1, shape);
  SetLimit(secondFront, secondBack, 2, shape);
  SetLimit(lastFront, lastBack, 3, shape);
}

inline Tile
TileLanes()
{
  Tile index;
  for (int i = 0; i < tileLanes; ++i)
  {
    index[i] = static_cast<float>(i);
  }
  return index;
}

/** A part of a cell's box of up to as many columns and rows as a tile has lanes. */
struct SpanPiece
{
  int   cell;        ///< in the block
  int   place;       ///< in the list of cells
  float column, row; ///< of its first pixel, less c0 and r0
  int   columns, rows;
  int   offset; ///< of its first pixel in the box: row * 256 + column
  int   out;    ///< from the band's first
};

/** Pixels of a block's cells. */
struct SpanList
{
  static constexpr int pixelCapacity = lanes * (maximumSpanBox + tileLanes);
  static constexpr int pieceCapacity = lanes * 32; ///< a box that FitsSpans has at most 32 of 8 x 8
  static constexpr int rowCapacity = pieceCapacity * tileLanes;

  SpanPiece      piece[pieceCapacity];
  int            pieces;
  unsigned short start[rowCapacity];      ///< of each piece's rows: the first pixel in the box
  int            pieceCount[rowCapacity]; ///< and the number of pixels
  int            count[rowCapacity];      ///< the number of pixels without the rows beyond a piece
  int            out[rowCapacity];        ///< where they begin, from the band's first
  int            rows;
  unsigned short place[pixelCapacity]; ///< row * 256 + column in the cell's box
  float          value[pixelCapacity];
  int            cell[lanes];
  float          column[lanes];  ///< of their boxes' first pixels, less c0
  float          row[lanes];     ///< less r0
  int            end[lanes + 1]; ///< of each one's pixels
  int            cells;

  void
  Clear()
  {
    pieces = rows = cells = end[0] = 0;
  }
};

/** Adds cell `g` to the list, its pixels not yet. */
inline void
AddToSpans(int g, const PixelBox & box, double c0, double r0, const Band & band, SpanList & list)
{
  const float column = static_cast<float>(box.firstColumn - c0), row = static_cast<float>(box.firstRow - r0);
  const int   columns = box.endColumn - box.firstColumn, rows = box.endRow - box.firstRow;
  const int   stride = static_cast<int>(band.stride);
  const int   out = (box.firstRow - band.firstRow) * stride + box.firstColumn - band.firstColumn;
  for (int c = 0; c < columns; c += tileLanes)
  {
    for (int r = 0; r < rows; r += tileLanes)
    {
      list.piece[list.pieces++] = { g,
                                    list.cells,
                                    column + c,
                                    row + r,
                                    columns - c < tileLanes ? columns - c : tileLanes,
                                    rows - r < tileLanes ? rows - r : tileLanes,
                                    256 * r + c,
                                    out + r * stride + c };
    }
  }
  list.cell[list.cells] = g;
  list.column[list.cells] = column;
  list.row[list.cells] = row;
  ++list.cells;
}

/** Finds the rows of all pieces. */
inline __attribute__((always_inline)) void
SetRows(const BlockShape & shape, std::ptrdiff_t stride, SpanList & list)
{
  constexpr float margin = 0.01f;
  const Tile      index = TileLanes(), zero{};
  const TileIndex none{}, indices = __builtin_convertvector(index, TileIndex);
  const TileIndex below = indices * static_cast<int>(stride);
  for (int p = 0; p < list.pieces; ++p)
  {
    const SpanPiece & piece = list.piece[p];
    const int         g = piece.cell;
    const Tile        y = index + piece.row;
    Tile              low = zero - 1, high = zero + static_cast<float>(piece.columns);
    for (int i = 0; i < BlockShape::limits; ++i)
    {
      const Tile left = shape.low[i][1][g] * y + (shape.low[i][0][g] - piece.column);
      const Tile right = shape.high[i][1][g] * y + (shape.high[i][0][g] - piece.column);
      low = left > low ? left : low;
      high = right < high ? right : high;
    }
    // An empty row's place is written to, too.
    const Tile beside = zero + static_cast<float>(piece.columns);
    low = low < beside ? low : beside;
    // Rounded towards 0: [-1, 0] gives 0, as it must.
    TileIndex from = __builtin_convertvector(low + (1 - margin), TileIndex);
    TileIndex to = __builtin_convertvector(high + (1 + margin), TileIndex);
    to = to < piece.columns ? to : none + piece.columns;
    TileIndex count = to - from;
    count = (count > 0) & (indices < piece.rows) ? count : none;
    StoreVector(list.pieceCount + p * tileLanes, count);
    StoreVector(list.start + p * tileLanes, __builtin_convertvector(from + (indices * 256 + piece.offset), TilePlaces));
    StoreVector(list.count + list.rows, count);
    StoreVector(list.out + list.rows, from + (below + piece.out));
    list.rows += piece.rows;
  }
}

/** Lists the pixels of all rows. */
inline __attribute__((always_inline)) void
SetPixels(SpanList & list)
{
  const TilePlaces places = __builtin_convertvector(TileLanes(), TilePlaces);
  unsigned short * to = list.place;
  for (int p = 0; p < list.pieces; ++p)
  {
    const unsigned short * const start = list.start + p * tileLanes;
    const int * const            count = list.pieceCount + p * tileLanes;
    for (int j = 0; j < tileLanes; ++j)
    {
      StoreVector(to, places + start[j]);
      to += count[j];
    }
    list.end[list.piece[p].place + 1] = static_cast<int>(to - list.place);
  }
}

/** The polynomials in z at pixels (xi, eta), from a lane of RayPolynomials. */
template <int N>
inline __attribute__((always_inline)) void
SetPixelPolynomials(const float * densities, const Tile & xi, const Tile & eta, Tile (&inZ)[N + 1])
{
  const Tile zero{};
  RepeatDegrees<N + 1>([&](int k) __attribute__((always_inline)) {
    RepeatDegrees<N + 1>([&](int fromLast) __attribute__((always_inline)) {
      const int           b = N - fromLast;
      const float * const from = densities + (b * (N + 1) * (N + 1) + k * (N + 1)) * lanes;
      Tile                inXi{};
      RepeatDegrees<N + 1>([&](int i) __attribute__((always_inline)) {
        const int a = N - i;
        if (a + b <= N)
        {
          inXi = a + b == N ? from[a * lanes] - zero : inXi * xi + from[a * lanes];
        }
      });
      inZ[k] = b == N ? inXi : inZ[k] * eta + inXi;
    });
  });
}

/** The integrals along the rays of the pixels of the list's cell `k`, and of what follows up to a whole tile. */
template <int N, int TFronts>
inline void
IntegrateCell(const BlockShape & shape, int k, const float * densities, SpanList & list)
{
  const int           g = list.cell[k], end = list.end[k + 1];
  const float * const planes = reinterpret_cast<const float *>(shape.depth) + g;
  const auto          at = [planes](int i, const Tile & c, const Tile & r) __attribute__((always_inline))
  {
    const float * const plane = planes + 3 * i * lanes;
    return plane[0] + plane[lanes] * c + plane[2 * lanes] * r;
  };
  const Tile  zero{};
  const float perWidth = shape.perWidth[g], perHeight = shape.perHeight[g];
  const float column = list.column[k], row = list.row[k];
  for (int i = list.end[k]; i < end; i += tileLanes)
  {
    // The cell's numbers are broadcast from memory as they are needed: kept, they would not fit the registers.
    __asm__ volatile("" : : : "memory");
    const TileIndex place = __builtin_convertvector(LoadVector<TilePlaces>(list.place + i), TileIndex);
    const Tile      c = __builtin_convertvector(place & 255, Tile) + column;
    const Tile      r = __builtin_convertvector(place >> 8, Tile) + row;
    Tile            entry = at(0, c, r);
    for (int f = 1; f < TFronts; ++f)
    {
      const Tile other = at(f, c, r);
      entry = other < entry ? other : entry;
    }
    Tile exit = at(TFronts, c, r);
    for (int b = TFronts + 1; b < 4; ++b)
    {
      const Tile other = at(b, c, r);
      exit = other > exit ? other : exit;
    }
    const Chord chord(entry, exit, shape.kappa[g]);
    Tile        inZ[N + 1];
    SetPixelPolynomials<N>(densities, c * perWidth, r * perHeight, inZ);
    const Tile value = chord.length * Mean<N>(inZ, chord.middle, chord.length);
    StoreVector(list.value + i, entry > exit ? value : zero);
  }
}

/** The integrals along the rays of all that is listed. */
template <int N>
inline void
IntegrateSpans(const BlockShape & shape, const float * densities, SpanList & list)
{
  for (int k = 0; k < list.cells; ++k)
  {
    switch (shape.fronts[list.cell[k]])
    {
      case 1:
        IntegrateCell<N, 1>(shape, k, densities + list.cell[k], list);
        break;
      case 2:
        IntegrateCell<N, 2>(shape, k, densities + list.cell[k], list);
        break;
      case 3:
        IntegrateCell<N, 3>(shape, k, densities + list.cell[k], list);
        break;
      default:
        break; // there is a front and a back
    }
  }
}

/** Adds the list to the image. By eight: most rows are shorter, and longer writes cross more borders of cache lines. */
inline __attribute__((always_inline)) void
AddSpans(const SpanList & list, const Band & band)
{
  const Batch      zero{};
  const BatchIndex index = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const int        rows = list.rows;
  const float *    value = list.value;
  for (int row = 0; row < rows; ++row)
  {
    float * const out = band.data + list.out[row];
    const int     count = list.count[row];
    Accumulate(out, index < count ? LoadVector<Batch>(value) : zero);
    if (count > lanes)
    {
      Accumulate(out + lanes, index + lanes < count ? LoadVector<Batch>(value + lanes) : zero);
    }
    value += count;
  }
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
