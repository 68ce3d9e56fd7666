/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Cells of few pixels. It is compiled like boneProjectionKernel.hxx, which describes a cell's frame.
//
// Most cells of a bone cover some forty pixels, in rows of four or five: too few to fill lanes that lie side by side in
// the image. So the pixels of a cell are listed row after row (spans), computed from the list, and added to the image
// row by row. Each of these steps is done for a block of cells before the next begins, so that no number is read
// right after it is written. Always inlined: called, GCC 12 takes SetRows for a function without effects and leaves the
// call out.

#include "boneTileKernel.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** Of higher degrees a polynomial reduced to the column, as in strips, costs less than one at each pixel. */
constexpr int maximumSpanDegree = 3;

/** Cells whose bounding box has more rows or columns than a byte counts do not fit, nor those with more pixels. An
 * image takes less time with strips from a smaller box on. */
constexpr int maximumSpanBox = 1024;
constexpr int imageSpanBox = 384;
constexpr int maximumSpanSide = 256;

inline bool
FitsSpans(const PixelBox & box, int most = maximumSpanBox)
{
  return box.Pixels() <= most && box.endRow - box.firstRow <= maximumSpanSide &&
         box.endColumn - box.firstColumn <= maximumSpanSide;
}

/** What the spans of a block need of its cells' frames. */
struct BlockShape
{
  static constexpr int limits = 4;

  Batch      depth[4][3];                     ///< of the face planes, fronts first: at the centre, per column, per row
  BatchIndex face[4];                         ///< the vertex opposite to each
  BatchIndex fronts;                          ///< how many of them are
  Batch      low[limits][2], high[limits][2]; ///< column limits less c0: at r0, per row; far away where there is none
  Batch      noFront[2];                      ///< 0 where the second, the third plane is a front, else far beyond
  Batch      noBack[2];                       ///< the same of backs, far before
  Batch      kappa;

  /** What has kappa^2 does not tell. */
  bool
  IsFar() const
  {
    constexpr float far = 1.0f / 128;
    float           largest = 0;
    for (int g = 0; g < lanes; ++g)
    {
      largest = kappa[g] > largest ? kappa[g] : largest;
    }
    return largest <= far;
  }
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
    const BatchIndex of = shape.face[i], other = shape.face[j];
    shape.face[i] = swapped ? other : of;
    shape.face[j] = swapped ? of : other;
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
  shape.kappa = Narrow(frames.kappa);
  BatchIndex front[4];
  shape.fronts = BatchIndex{};
  for (int i = 0; i < 4; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      shape.depth[i][k] = Narrow(frames.depth[i][k]);
    }
    shape.face[i] = BatchIndex{} + i;
    front[i] = Narrow(frames.slope[i]) < 0;
    shape.fronts -= front[i];
  }
  SortPlanes(shape, front);
  const Batch none{}, beyond = none + 1e30f;
  for (int i = 0; i < 2; ++i)
  {
    shape.noFront[i] = front[i + 1] != 0 ? none : beyond;
    shape.noBack[i] = front[i + 1] != 0 ? -beyond : none;
  }
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
  float column, row; ///< of its first pixel, less c0 and r0
  int   columns, rows;
  int   offset; ///< of its first pixel in the box: row * 256 + column
  int   out;    ///< from the band's first
};

/** Pixels of a block's cells; each cell's begin at a whole tile. */
struct SpanList
{
  static constexpr int pixelCapacity = lanes * (maximumSpanBox + 2 * tileLanes);
  static constexpr int pieceCapacity = lanes * 64; ///< a box that FitsSpans has fewer of 8 x 8
  static constexpr int rowCapacity = pieceCapacity * tileLanes;
  static constexpr int tilesOfCell = 160; ///< at least as many as a cell that FitsSpans has

  Tile           x[pixelCapacity / tileLanes], y[pixelCapacity / tileLanes]; ///< of the chord's middle, see MeanAlong
  Tile           z[pixelCapacity / tileLanes];
  Tile           length[pixelCapacity / tileLanes]; ///< of the chord in z
  float          value[pixelCapacity];              ///< the integral
  unsigned short place[pixelCapacity];              ///< row * 256 + column in the cell's box
  SpanPiece      piece[pieceCapacity];
  int            pieces;
  unsigned short start[rowCapacity];      ///< of each piece's rows: the first pixel in the box
  int            pieceCount[rowCapacity]; ///< and the number of pixels
  int            count[rowCapacity];      ///< the number of pixels without the rows beyond a piece
  int            out[rowCapacity];        ///< where they begin, from the band's first
  int            from[rowCapacity];       ///< where they begin in the list
  int            longer[rowCapacity + 1]; ///< which have more pixels than lanes
  int            rows;
  unsigned char  cellOf[pixelCapacity / tileLanes + tilesOfCell]; ///< of each tile
  int            pixels;                                          ///< of all, with those that fill up tiles
  float          column[lanes];                                   ///< of the cells' boxes' first pixels, less c0
  float          row[lanes];                                      ///< less r0

  void
  Clear()
  {
    pieces = rows = pixels = 0;
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
                                    column + c,
                                    row + r,
                                    columns - c < tileLanes ? columns - c : tileLanes,
                                    rows - r < tileLanes ? rows - r : tileLanes,
                                    256 * r + c,
                                    out + r * stride + c };
    }
  }
  list.column[g] = column;
  list.row[g] = row;
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
  int              to = 0, row = 0, cell = -1;
  for (int p = 0; p < list.pieces; ++p)
  {
    const SpanPiece &            piece = list.piece[p];
    const unsigned short * const start = list.start + p * tileLanes;
    const int * const            count = list.pieceCount + p * tileLanes;
    if (piece.cell != cell)
    {
      cell = piece.cell;
      to = (to + tileLanes - 1) & ~(tileLanes - 1);
      __builtin_memset(list.cellOf + to / tileLanes, cell, SpanList::tilesOfCell);
    }
    for (int j = 0; j < tileLanes; ++j)
    {
      StoreVector(list.place + to, places + start[j]);
      list.from[row + j] = to;
      to += count[j];
    }
    row += piece.rows;
  }
  list.pixels = to;
}

/** Sets the chords of all pixels. Whatever planes are fronts: a branch would be guessed wrong for many cells. */
inline void
SetChords(const BlockShape & shape, SpanList & list)
{
  const Tile zero{};
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
    const Tile second = at(1), third = at(2);
    Tile       entry = at(0), exit = at(3);
    const Tile secondFront = second + shape.noFront[0][g], thirdFront = third + shape.noFront[1][g];
    const Tile secondBack = second + shape.noBack[0][g], thirdBack = third + shape.noBack[1][g];
    entry = secondFront < entry ? secondFront : entry;
    exit = secondBack > exit ? secondBack : exit;
    entry = thirdFront < entry ? thirdFront : entry;
    exit = thirdBack > exit ? thirdBack : exit;
    const float kappa = shape.kappa[g];
    const Chord chord(entry, exit, kappa);
    const Tile  magnification = 1 + kappa * chord.middle;
    list.x[tile] = magnification * c;
    list.y[tile] = magnification * r;
    list.z[tile] = chord.middle;
    list.length[tile] = entry > exit ? chord.length : zero;
  }
}

/** The mean of a polynomial in X, Y and z along a chord, which begins and ends at z -+ length / 2 and has its middle at
 * (x, y, z). With its value p and its second derivative p'' along the ray there it is p + length^2 / 24 p'' up to
 * degree 3; the derivative along the ray is d/dz + kappa / (1 + kappa z) (X d/dX + Y d/dY). Where `TFar`, what has
 * kappa^2 is left out of p''. `q` points to a lane of Monomials. */
template <int N, bool TFar>
inline __attribute__((always_inline)) Tile
MeanAlong(const float * q, const Tile & x, const Tile & y, const Tile & z, const Tile & length, float kappa)
{
  static_assert(N <= 3, "the remainder is none up to degree 3");
  const auto of = [q](int a, int b, int k) __attribute__((always_inline))
  {
    return q[((a * (N + 1) + b) * (N + 1) + k) * lanes];
  };
  if constexpr (N == 0)
  {
    return Tile{} + of(0, 0, 0);
  }
  else if constexpr (N == 1)
  {
    return of(0, 0, 0) + of(1, 0, 0) * x + of(0, 1, 0) * y + of(0, 0, 1) * z;
  }
  else
  {
    // Sums of the terms of z^k that are homogeneous in X and Y.
    const Tile first = of(1, 0, 1) * x + of(0, 1, 1) * y;
    const Tile perSecond = (length * length) * (1.0f / 12);
    const Tile slope = TFar ? Tile{} + kappa : kappa / (1 + kappa * z);
    if constexpr (N == 2)
    {
      const Tile value =
        of(0, 0, 0) + x * (of(1, 0, 0) + of(2, 0, 0) * x) + y * (of(0, 1, 0) + of(1, 1, 0) * x + of(0, 2, 0) * y);
      Tile half = of(0, 0, 2) + slope * first; // of p''
      if constexpr (!TFar)
      {
        half += slope * slope * (x * (of(2, 0, 0) * x + of(1, 1, 0) * y) + y * (of(0, 2, 0) * y));
      }
      return value + z * (of(0, 0, 1) + first + z * of(0, 0, 2)) + perSecond * half;
    }
    else
    {
      const Tile value =
        of(0, 0, 0) + x * (of(1, 0, 0) + x * (of(2, 0, 0) + of(3, 0, 0) * x)) +
        y * (of(0, 1, 0) + x * (of(1, 1, 0) + of(2, 1, 0) * x) + y * (of(0, 2, 0) + of(1, 2, 0) * x + of(0, 3, 0) * y));
      const Tile second = x * (of(2, 0, 1) * x + of(1, 1, 1) * y) + y * (of(0, 2, 1) * y);
      const Tile firstOfSquare = of(1, 0, 2) * x + of(0, 1, 2) * y, square = of(0, 0, 2) + firstOfSquare;
      const Tile third = of(0, 0, 3) * z;
      Tile       half = square + 3 * third + slope * (first + 2 * (second + z * firstOfSquare)); // of p''
      if constexpr (!TFar)
      {
        half += slope * slope *
                (x * x * (of(2, 0, 0) + 3 * (of(3, 0, 0) * x + of(2, 1, 0) * y)) + of(1, 1, 0) * (x * y) +
                 y * y * (of(0, 2, 0) + 3 * (of(1, 2, 0) * x + of(0, 3, 0) * y)) + z * second);
      }
      return value + z * (of(0, 0, 1) + first + second + z * (square + third)) + perSecond * half;
    }
  }
}

/** The integrals along all chords. */
template <int N, bool TFar>
inline void
IntegrateChords(const BlockShape & shape, const float * monomials, SpanList & list)
{
  for (int i = 0; i < list.pixels; i += tileLanes)
  {
    // The cell's numbers are broadcast from memory as they are needed: kept, they would not fit the registers.
    __asm__ volatile("" : : : "memory");
    const int  tile = i / tileLanes, g = list.cellOf[tile];
    const Tile length = list.length[tile];
    const Tile mean =
      MeanAlong<N, TFar>(monomials + g, list.x[tile], list.y[tile], list.z[tile], length, shape.kappa[g]);
    StoreVector(list.value + i, length * mean);
  }
}

/** The integrals along the rays of all that is listed. First all chords: their divisions take long, and a processor
 * that waits for one does not see far enough ahead to do much else. */
template <int N>
inline void
IntegrateSpans(const BlockShape & shape, const float * monomials, SpanList & list)
{
  SetChords(shape, list);
  if (N < 2 || shape.IsFar())
  {
    IntegrateChords<N, true>(shape, monomials, list);
  }
  else
  {
    IntegrateChords<N, false>(shape, monomials, list);
  }
}

/** Adds the list to the image. By eight: most rows are shorter, and longer writes cross more borders of cache lines.
 * What is longer comes after, again without branches that would be guessed wrong. */
inline __attribute__((always_inline)) void
AddSpans(SpanList & list, const Band & band)
{
  const Batch      zero{};
  const BatchIndex index = { 0, 1, 2, 3, 4, 5, 6, 7 };
  int              longer = 0;
  for (int row = 0; row < list.rows; ++row)
  {
    const int count = list.count[row];
    Accumulate(band.data + list.out[row], index < count ? LoadVector<Batch>(list.value + list.from[row]) : zero);
    list.longer[longer] = row;
    longer += count > lanes ? 1 : 0;
  }
  for (int i = 0; i < longer; ++i)
  {
    const int row = list.longer[i], count = list.count[row] - lanes;
    Accumulate(band.data + list.out[row] + lanes,
               index < count ? LoadVector<Batch>(list.value + list.from[row] + lanes) : zero);
  }
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
