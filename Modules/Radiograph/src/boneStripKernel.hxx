/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The image of the tetrahedra, compiled like boneProjectionKernel.hxx, which see for the cell's frame.
//
// Most cells of a bone cover some forty pixels, so that little may be done for each cell and row. Eight cells are set
// up at once. Each is then filled by strips of eight columns: a lane keeps its column from row to row, so that the
// polynomial is reduced to one in (eta, z) a lane once a strip, and a row takes some forty instructions without
// branches. What a row of a strip has beside the cell costs nothing but lanes.

#include "boneProjectionKernel.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** Cells that cover more strips take AddRows. */
constexpr int maximumStrips = lanes;

/** Planes as fronts from the left and backs from the right, by the bits of the fronts. */
struct PlaneOrder
{
  unsigned char plane[16][4]{};
  unsigned char fronts[16]{};
  constexpr PlaneOrder()
  {
    for (int bits = 0; bits < 16; ++bits)
    {
      int front = 0, back = 3;
      for (int i = 0; i < 4; ++i)
      {
        plane[bits][(bits >> i) & 1 ? front++ : back--] = static_cast<unsigned char>(i);
      }
      fronts[bits] = static_cast<unsigned char>(front);
    }
  }
};
constexpr PlaneOrder planeOrder;

/** A group's cells in the band. */
struct GroupPlace
{
  typedef int Columns __attribute__((vector_size(groupSize * sizeof(int))));

  int   firstRow[groupSize], endRow[groupSize]; ///< in the band
  int   firstColumn[groupSize], endColumn[groupSize];
  int   fronts[groupSize]; ///< bits of the planes
  bool  seen[groupSize];
  bool  exact[groupSize];    ///< needs double precision
  Group depth[3][groupSize]; ///< of each cell: of its planes, as in GroupFrame
};

/** Rows or columns of a range that lie in [first, end). */
inline void
CutRange(const Group (&range)[2], int first, int end, int (&from)[groupSize], int (&to)[groupSize])
{
  const Group lowest = Group{} + first, highest = Group{} + (end - 1.0);
  const Group low = range[0] > lowest ? range[0] : lowest, high = range[1] < highest ? range[1] : highest;
  for (int g = 0; g < groupSize; ++g)
  {
    from[g] = -Floor(-low[g]);
    to[g] = Floor(high[g]) + 1;
  }
}

/** Not from centre and half extent, which are rounded: a face that lies along a row must end there. */
inline void
SetPlace(const GroupFrame & frame, const Band & band, GroupPlace & place)
{
  constexpr double steep = 1e-3;
  CutRange(frame.rows, band.firstRow, band.endRow, place.firstRow, place.endRow);
  CutRange(frame.columns, 0, band.columns, place.firstColumn, place.endColumn);
  typedef long long Flags __attribute__((vector_size(sizeof(Group))));
  Flags             fronts{}, edgeOn{};
  for (int i = 0; i < 4; ++i)
  {
    fronts |= (frame.slope[i] < 0) & (Flags{} + (1LL << i));
    edgeOn |= !(Absolute(frame.slope[i]) >= steep * frame.inPlane[i]);
  }
  const Flags solid =
    (frame.halfWidth > 0) & (frame.halfHeight > 0) & (frame.halfDepth > 0) & (Absolute(frame.volume) > 0);
  for (int g = 0; g < groupSize; ++g)
  {
    place.fronts[g] = static_cast<int>(fronts[g]);
    place.exact[g] = edgeOn[g] != 0;
    place.seen[g] = solid[g] != 0 && place.firstRow[g] < place.endRow[g] && place.firstColumn[g] < place.endColumn[g];
  }
  for (int k = 0; k < 3; ++k)
  {
    const Group planes[4] = { frame.depth[0][k], frame.depth[1][k], frame.depth[2][k], frame.depth[3][k] };
    Transpose(planes, place.depth[k]);
  }
}

/** One cell as its strips need it. */
struct StripCell
{
  double c0, r0;
  float  perWidth, perHeight; ///< 1 / half extent
  float  kappa;
  Group  depth[3];
  int    fronts; ///< bits
};

/** Rows that are computed at once, and a lane for each of their pixels. */
constexpr int tileRows = BONE_PROJECTION_TILE_ROWS;
typedef float Tile __attribute__((vector_size(tileRows * lanes * sizeof(float))));

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

/** Rows [firstRow, endRow) of the eight columns from `column`; rows of the last tile beyond are written, too.
 * `densities` points to the cell's lane of the coefficients, which are `lanes` apart. */
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
  const Tile    xi = (index + static_cast<float>(dc)) * cell.perWidth;
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
  const unsigned char(&order)[4] = planeOrder.plane[cell.fronts];
  const Planes perColumn = __builtin_convertvector(cell.depth[1], Planes);
  const Planes perRow = __builtin_convertvector(cell.depth[2], Planes);
  float        columnSteps[4], rowSteps[4];
  __builtin_memcpy(columnSteps, &perColumn, sizeof(columnSteps));
  __builtin_memcpy(rowSteps, &perRow, sizeof(rowSteps));
  Tile along[4];
  for (int i = 0; i < 4; ++i)
  {
    along[i] = columnSteps[order[i]] * index + rowSteps[order[i]] * rows;
  }
  Group       start = cell.depth[0] + cell.depth[1] * dc + cell.depth[2] * dr;
  const Group step = tileRows * cell.depth[2];
  Tile        eta = (rows + static_cast<float>(dr)) * cell.perHeight;
  const float etaStep = tileRows * cell.perHeight;
  for (int row = firstRow; row < endRow; row += tileRows)
  {
    float        at[4];
    const Planes rounded = __builtin_convertvector(start, Planes);
    __builtin_memcpy(at, &rounded, sizeof(at));
    // Broadcast from memory: to permute them out of registers takes longer.
    __asm__ volatile("" : "+m"(at));
    Tile entry = along[0] + at[order[0]];
    for (int i = 1; i < TFronts; ++i)
    {
      const Tile depth = along[i] + at[order[i]];
      entry = depth < entry ? depth : entry;
    }
    Tile exit = along[TFronts] + at[order[TFronts]];
    for (int i = TFronts + 1; i < 4; ++i)
    {
      const Tile depth = along[i] + at[order[i]];
      exit = depth > exit ? depth : exit;
    }
    const Tile a = 1 + cell.kappa * entry, b = 1 + cell.kappa * exit;
    const Tile inverse = 1 / (a * b);
    const Tile length = (entry - exit) * inverse;
    const Tile middle = 0.5f * length - entry * (b * inverse);
    Tile       inZ[N + 1];
    for (int k = 0; k <= N; ++k)
    {
      inZ[k] = inEta[k][N];
      for (int power = N - 1; power >= 0; --power)
      {
        inZ[k] = inZ[k] * eta + inEta[k][power];
      }
    }
    const Tile value = length * Mean<N>(inZ, middle, length);
    AccumulateTile(out, stride, entry > exit ? value : zero);
    out += tileRows * stride;
    start += step;
    eta += etaStep;
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
SetStripRows(const GroupFrame & frame,
             const Group (&column)[4],
             const Group (&row)[4],
             int         member,
             int         first,
             StripRows & rows)
{
  float x[4], y[4];
  for (int i = 0; i < 4; ++i)
  {
    x[i] = static_cast<float>(column[i][member] - (first - 0.5));
    y[i] = static_cast<float>(row[i][member] - frame.r0[member]);
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
AddStrips(const StripCell &  cell,
          const float *      densities,
          const StripRows *  rows,
          const GroupPlace & place,
          int                member,
          const Band &       band)
{
  constexpr float margin = 0.01f;
  int             strip = 0;
  for (int column = place.firstColumn[member]; column < place.endColumn[member]; column += lanes, ++strip)
  {
    int first = place.firstRow[member], end = place.endRow[member];
    if (rows != nullptr)
    {
      const int low = -Floor(margin - rows->low[strip] - cell.r0),
                high = Floor(rows->high[strip] + margin + cell.r0) + 1;
      first = low > first ? low : first;
      end = high < end ? high : end;
    }
    AddStrip<N, TFronts>(
      cell, densities, column, first, end, band.data + (first - band.firstRow) * band.stride + column, band.stride);
  }
}

/** Up to eight cells of a run. */
template <int N>
class BatchAdder
{
public:
  BatchAdder(const CellRun & run, const Band & band)
    : m_Run(run)
    , m_Band(band)
  {}

  /** `next` is what comes after these cells, of which there are `count`. */
  void
  Add(const std::int32_t * ids, int count, const std::int32_t * next, std::size_t nextCount)
  {
    for (std::size_t g = 0; g < nextCount; ++g)
    {
      const double * const start = m_Run.coefficients + next[g] * static_cast<std::ptrdiff_t>(m_Run.stride);
      for (int p = 0; p < CoefficientCount(N) + lanes - 1; p += lanes)
      {
        __builtin_prefetch(start + p);
      }
    }
    for (int g = 0; g < batchSize; ++g)
    {
      m_Coefficients[g] = m_Run.coefficients + ids[g < count ? g : 0] * static_cast<std::ptrdiff_t>(m_Run.stride);
    }
    for (int half = 0; half < 2; ++half)
    {
      LoadVertices(ids, count, half);
      SetGroupFrame(m_Column[half], m_Row[half], m_S[half], m_Run.parallel, m_Frames[half]);
      SetPlace(m_Frames[half], m_Band, m_Places[half]);
    }
    SetBatchDensities();
    bool exactSet[2] = { false, false };
    for (int g = 0; g < count; ++g)
    {
      const int          half = g / groupSize, member = g % groupSize;
      const GroupPlace & place = m_Places[half];
      if (!place.seen[member])
      {
        continue;
      }
      constexpr float largestGrowth = 64;
      if (place.exact[member] || !(m_Densities.growth[g] <= largestGrowth))
      {
        if (!exactSet[half])
        {
          SetExactDensities(half);
          exactSet[half] = true;
        }
        AddExact(half, member);
      }
      else
      {
        AddCell(half, member);
      }
    }
  }

private:
  void
  LoadVertices(const std::int32_t * ids, int count, int half)
  {
    for (int i = 0; i < 4; ++i)
    {
      Group points[groupSize], columns[groupSize];
      for (int g = 0; g < groupSize; ++g)
      {
        const int          cell = half * groupSize + g;
        const std::int32_t v = m_Run.vertices[4 * static_cast<std::ptrdiff_t>(ids[cell < count ? cell : 0]) + i];
        __builtin_memcpy(points + g, m_Run.points + 4 * static_cast<std::ptrdiff_t>(v), sizeof(Group));
      }
      Transpose(points, columns);
      m_Column[half][i] = columns[0];
      m_Row[half][i] = columns[1];
      m_S[half][i] = columns[2];
    }
  }
  void
  SetBatchDensities()
  {
    Batch mu[4][4], control[CoefficientCount(N)];
    for (int k = 0; k < 4; ++k)
    {
      for (int i = 0; i < 4; ++i)
      {
        mu[k][i] = Narrow(m_Frames[0].mu[k][i], m_Frames[1].mu[k][i]);
      }
    }
    const Group low = m_Frames[0].halfDepth, high = m_Frames[1].halfDepth;
    LoadControl<N>(m_Coefficients,
                   Narrow(low * m_Run.scale, high * m_Run.scale),
                   Narrow(low * m_Run.offset, high * m_Run.offset),
                   control);
    SetDensities<N, Batch>(control, mu, Narrow(m_Frames[0].kappa, m_Frames[1].kappa), m_Densities);
  }
  void
  SetExactDensities(int half)
  {
    const double * coefficients[groupSize];
    for (int g = 0; g < groupSize; ++g)
    {
      coefficients[g] = m_Coefficients[half * groupSize + g];
    }
    const GroupFrame & frame = m_Frames[half];
    Group              control[CoefficientCount(N)];
    LoadControl<N>(coefficients, frame.halfDepth * m_Run.scale, frame.halfDepth * m_Run.offset, control);
    SetDensities<N, Group>(control, frame.mu, frame.kappa, m_Exact[half]);
  }
  void
  AddExact(int half, int member)
  {
    Frame frame;
    if (PlaceFrame(m_Frames[half], member, m_Band, frame) && SetPlanes(m_Frames[half], member, frame))
    {
      AddInPrecision<double, N>(frame, RowPolynomial<double, N>(m_Exact[half], member), m_Band);
    }
  }
  void
  AddCell(int half, int member)
  {
    const GroupFrame & frames = m_Frames[half];
    const GroupPlace & place = m_Places[half];
    const int          columns = place.endColumn[member] - place.firstColumn[member];
    if (columns > maximumStrips * lanes)
    {
      Frame frame;
      if (PlaceFrame(frames, member, m_Band, frame) && SetPlanes(frames, member, frame))
      {
        AddInPrecision<float, N>(frame, RowPolynomial<float, N>(m_Densities, half * groupSize + member), m_Band);
      }
      return;
    }
    StripCell cell;
    cell.c0 = frames.c0[member];
    cell.r0 = frames.r0[member];
    cell.perWidth = static_cast<float>(frames.perWidth[member]);
    cell.perHeight = static_cast<float>(frames.perHeight[member]);
    cell.kappa = static_cast<float>(frames.kappa[member]);
    for (int k = 0; k < 3; ++k)
    {
      cell.depth[k] = place.depth[k][member];
    }
    cell.fronts = place.fronts[member];
    StripRows   rows;
    StripRows * limits = nullptr;
    if (columns > lanes)
    {
      SetStripRows(frames, m_Column[half], m_Row[half], member, place.firstColumn[member], rows);
      limits = &rows;
    }
    const float * const densities = reinterpret_cast<const float *>(m_Densities.a) + half * groupSize + member;
    switch (planeOrder.fronts[cell.fronts])
    {
      case 1:
        AddStrips<N, 1>(cell, densities, limits, place, member, m_Band);
        break;
      case 2:
        AddStrips<N, 2>(cell, densities, limits, place, member, m_Band);
        break;
      case 3:
        AddStrips<N, 3>(cell, densities, limits, place, member, m_Band);
        break;
      default:
        break; // no front or no back: too flat to be seen
    }
  }

  const CellRun & m_Run;
  const Band &    m_Band;
  const double *  m_Coefficients[batchSize];
  Group           m_Column[2][4], m_Row[2][4], m_S[2][4];
  GroupFrame      m_Frames[2];
  GroupPlace      m_Places[2];

  RayPolynomials<N, Batch> m_Densities;
  RayPolynomials<N, Group> m_Exact[2];
};

template <int N>
void
AddOfDegree(const CellRun & run, const Band & band)
{
  BatchAdder<N> adder(run, band);
  for (std::size_t i = 0; i < run.count; i += batchSize)
  {
    const std::size_t left = run.count - i, next = left < batchSize ? 0 : left - batchSize;
    adder.Add(run.ids + i,
              left < batchSize ? static_cast<int>(left) : batchSize,
              run.ids + i + batchSize,
              next < batchSize ? next : batchSize);
  }
}

inline void
AddCells(const CellRun & run, const Band & band)
{
  using Function = void (*)(const CellRun &, const Band &);
  constexpr Function byDegree[] = { AddOfDegree<0>, AddOfDegree<1>, AddOfDegree<2>, AddOfDegree<3>, AddOfDegree<4>,
                                    AddOfDegree<5>, AddOfDegree<6>, AddOfDegree<7>, AddOfDegree<8> };
  byDegree[run.degree](run, band);
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
