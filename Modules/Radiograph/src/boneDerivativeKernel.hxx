/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Derivatives of the projection. Those of a pixel are sums over its terms (boneRayTerms.hxx) for all modes at once.

#include "boneRayChords.hxx"
#include "boneRayTerms.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** One number of each of some modes. */
typedef float Modes __attribute__((vector_size(modeLanes * sizeof(float))));

/** A block of modes in one cell, as factors of the terms. */
template <int TCount>
struct ModeTable
{
  Modes of[TCount];
};

/** Numbers in single precision, then zeros. */
template <int TCount>
inline __attribute__((always_inline)) Batch
LoadRounded(const double * from)
{
  typedef double Wide __attribute__((vector_size(lanes * sizeof(double))));
  Wide           value{};
  __builtin_memcpy(&value, from, TCount * sizeof(double));
  return __builtin_convertvector(value, Batch);
}

/** Modes of a cell, coefficients [start, start + TCount). */
template <int TCount>
inline __attribute__((always_inline)) void
LoadModes(const double * const (&from)[modeLanes], int start, Modes (&to)[lanes])
{
  Batch rows[lanes], low[lanes], high[lanes];
  for (int m = 0; m < lanes; ++m)
  {
    rows[m] = LoadRounded<TCount>(from[m] + start);
  }
  TransposeBlock(rows, low);
  for (int m = 0; m < lanes; ++m)
  {
    rows[m] = LoadRounded<TCount>(from[lanes + m] + start);
  }
  TransposeBlock(rows, high);
  // Whole vectors: to read what was written by halves has to wait until it is in the cache.
  for (int k = 0; k < lanes; ++k)
  {
    to[k] = __builtin_shufflevector(low[k], high[k], 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
}

/** Block of density modes (the density itself being the first) of a cell. */
template <int N>
inline void
SetDensityTable(const BlockRun &                 run,
                const Derivatives &              derivatives,
                std::int32_t                     cell,
                double                           halfDepth,
                int                              block,
                ModeTable<CoefficientCount(N)> & table)
{
  constexpr int           count = CoefficientCount(N), whole = count / lanes, left = count % lanes;
  static constexpr double none[count] = {};
  const std::size_t       first = static_cast<std::size_t>(cell) * run.densityStride;
  const double *          from[modeLanes];
  for (int m = 0; m < modeLanes; ++m)
  {
    const int mode = block * modeLanes + m;
    from[m] = mode < derivatives.densityModes ? derivatives.density[mode] + first : none;
  }
  const auto scale = static_cast<float>(halfDepth * run.scale);
  Modes      offset{};
  offset[0] = block == 0 ? static_cast<float>(halfDepth * run.offset) : 0.0f;
  const auto set = [&](int start, int k, const Modes & value) __attribute__((always_inline))
  {
    table.of[start + k] = static_cast<float>(basisFactors<N>.of[start + k]) * (scale * value + offset);
  };
  RepeatLow<N, whole>([&](int piece) __attribute__((always_inline)) {
    Modes values[lanes];
    LoadModes<lanes>(from, piece * lanes, values);
    Repeat<lanes>([&](int k) __attribute__((always_inline)) { set(piece * lanes, k, values[k]); });
  });
  if constexpr (left > 0)
  {
    // The last eight, some of them again, or all where there are less.
    constexpr int loaded = whole > 0 ? lanes : left, start = count - loaded;
    Modes         values[lanes];
    LoadModes<loaded>(from, start, values);
    Repeat<left>([&](int k) __attribute__((always_inline)) { set(count - left, k, values[loaded - left + k]); });
  }
}

/** Block of displacements of a cell's vertices. */
inline void
SetVertexTable(const Derivatives & derivatives, std::int32_t cell, int block, ModeTable<vertexTerms> & table)
{
  const int                  stride = derivatives.vertexBlocks * modeLanes;
  const std::int32_t * const vertices = derivatives.vertices + 4 * static_cast<std::size_t>(cell);
  Repeat<vertexTerms>([&](int q) __attribute__((always_inline)) {
    const float * const from = derivatives.displacement + 3 * static_cast<std::size_t>(vertices[q / 3]) * stride +
                               q % 3 * stride + block * modeLanes;
    __builtin_memcpy(table.of + q, from, sizeof(Modes));
  });
}

/** Terms of the listed pixels, [term][pixel]. */
template <int TCount>
struct alignas(64) TermList
{
  float of[TCount][listSize];
};

/** Adds a block of modes at the listed pixels, which are `plane` numbers apart. */
template <int TCount>
inline __attribute__((always_inline)) void
AddBlock(const ModeTable<TCount> & modes,
         const TermList<TCount> &  terms,
         const std::int32_t *      at,
         int                       count,
         float *                   out,
         std::ptrdiff_t            plane)
{
  Modes table[TCount];
  Repeat<TCount>([&](int q) __attribute__((always_inline)) { table[q] = modes.of[q]; });
#if BONE_PROJECTION_TILE_ROWS > 1
  // To stay in registers: to read it again for each pixel takes longer.
  if constexpr (TCount <= 20)
  {
    Repeat<TCount>([&](int q) __attribute__((always_inline)) { __asm__("" : "+v"(table[q])); });
  }
#endif
  for (int i = 0; i < count; ++i)
  {
    float * const to = out + at[i] * plane;
    Modes         sum, odd{};
    __builtin_memcpy(&sum, to, sizeof(sum));
    Repeat<TCount>([&](int q)
                     __attribute__((always_inline)) { (q % 2 == 0 ? sum : odd) += table[q] * terms.of[q][i]; });
    sum += odd;
    __builtin_memcpy(to, &sum, sizeof(sum));
  }
}

template <typename TLanes>
inline void
StoreRounded(const TLanes & value, float * to)
{
  constexpr int size = sizeof(TLanes) / sizeof(value[0]);
  typedef float Rounded __attribute__((vector_size(size * sizeof(float))));
  const Rounded rounded = __builtin_convertvector(value, Rounded);
  __builtin_memcpy(to, &rounded, sizeof(rounded));
}

/** Adds the terms of a cell's listed pixels, times its modes, to the band. */
template <int N>
class ModeAdder
{
public:
  static constexpr int count = CoefficientCount(N);

  ModeAdder(const BlockRun &    run,
            const Derivatives & derivatives,
            const Band &        band,
            std::int32_t        cell,
            double              halfDepth)
    : m_Run(run)
    , m_Derivatives(derivatives)
    , m_Band(band)
    , m_Cell(cell)
    , m_HalfDepth(halfDepth)
  {
    // Mostly there is one block of each, which is set up once.
    SetDensityTable<N>(run, derivatives, cell, halfDepth, 0, m_Density);
    if (derivatives.vertexBlocks > 0)
    {
      SetVertexTable(derivatives, cell, 0, m_Vertex);
    }
  }

  void
  Add(const TermList<count> & basis, const TermList<vertexTerms> & vertex, const std::int32_t * at, int pixels)
  {
    const int plane = (m_Derivatives.vertexBlocks + m_Derivatives.densityBlocks) * modeLanes;
    float *   out = m_Band.data;
    for (int block = 0; block < m_Derivatives.vertexBlocks; ++block, out += modeLanes)
    {
      if (m_Derivatives.vertexBlocks > 1)
      {
        SetVertexTable(m_Derivatives, m_Cell, block, m_Vertex);
      }
      AddBlock(m_Vertex, vertex, at, pixels, out, plane);
    }
    for (int block = 0; block < m_Derivatives.densityBlocks; ++block, out += modeLanes)
    {
      if (m_Derivatives.densityBlocks > 1)
      {
        SetDensityTable<N>(m_Run, m_Derivatives, m_Cell, m_HalfDepth, block, m_Density);
      }
      AddBlock(m_Density, basis, at, pixels, out, plane);
    }
  }

private:
  const BlockRun &    m_Run;
  const Derivatives & m_Derivatives;
  const Band &        m_Band;
  std::int32_t        m_Cell;
  double              m_HalfDepth;

  ModeTable<count>       m_Density;
  ModeTable<vertexTerms> m_Vertex;
};

/** Sets the means of all products of N barycentric coordinates, times `weight`, along chords with middles `middle` and
 * half differences `half`, as two Gauss points give them: a product of N - 1 is even + odd, the part that is the same
 * at both points and that which changes its sign. */
template <int N, typename TSet>
inline __attribute__((always_inline)) void
SetProductMeans(const Tile (&middle)[4], const Tile (&half)[4], const Tile & weight, const TSet & set)
{
  static_assert(N <= 3, "two points are exact up to degree 3");
  if constexpr (N == 0)
  {
    set(0, weight);
  }
  else
  {
    constexpr int   lower = CoefficientCount(N - 1);
    constexpr float third = 1.0f / 3;
    Tile            weighed[4], step[4], even[lower], odd[lower], sums[CoefficientCount(N)];
    Repeat<4>([&](int i) __attribute__((always_inline)) {
      weighed[i] = weight * middle[i];
      step[i] = third * half[i];
    });
    if constexpr (N == 1)
    {
      even[0] = Tile{} + 1;
    }
    else if constexpr (N == 2)
    {
      Repeat<4>([&](int i) __attribute__((always_inline)) {
        even[i] = middle[i];
        odd[i] = half[i];
      });
    }
    else
    {
      RaiseProducts<2>(
        middle, middle, [&](int p, const Tile & value) __attribute__((always_inline)) { even[p] = value; });
      RaiseProducts<2>(
        half, step, [&](int p, const Tile & value) __attribute__((always_inline)) { even[p] += value; });
      RaiseProducts<2>(
        middle, half, [&](int p, const Tile & value) __attribute__((always_inline)) { odd[p] = value; });
      RaiseProducts<2>(
        half, middle, [&](int p, const Tile & value) __attribute__((always_inline)) { odd[p] += value; });
    }
    RaiseProducts<N>(
      even, weighed, [&](int p, const Tile & value) __attribute__((always_inline)) { sums[p] = value; });
    if constexpr (N > 1)
    {
      Repeat<4>([&](int i) __attribute__((always_inline)) { step[i] *= weight; });
      RaiseProducts<N>(
        odd, step, [&](int p, const Tile & value) __attribute__((always_inline)) { sums[p] += value; });
    }
    Repeat<CoefficientCount(N)>([&](int p) __attribute__((always_inline)) { set(p, sums[p]); });
  }
}

/** Derivatives in blocks of one degree. */
template <int N>
class BlockDeriver : private BlockSetup<N>
{
public:
  static constexpr int count = CoefficientCount(N);

  BlockDeriver(const BlockRun & run, const Derivatives & derivatives, const Band & band)
    : BlockSetup<N>(run, band)
    , m_Derivatives(derivatives)
  {}

  /** `next`: the block to come. */
  void
  Add(std::size_t block, std::size_t next)
  {
    FetchModes(m_Run.cells[block * lanes]);
    this->SetBlock(block, next);
    CellGroup group;
    group.count = 0;
    group.degree = N;
    group.scale = m_Run.scale;
    group.offset = m_Run.offset;
    group.parallel = m_Run.parallel;
    std::int32_t     members[groupSize];
    const BatchIndex precise = m_Exact | m_Fine | this->FindFarReaching();
    for (int g = 0; g < lanes && m_Cells[g] >= 0; ++g)
    {
      if (m_Seen[g] == 0)
      {
        continue;
      }
      if (N <= maximumSpanDegree && precise[g] == 0 && FitsSpans(this->BoxOf(g)))
      {
        AddToSpans(g, this->BoxOf(g), m_Frames.c0[g], m_Frames.r0[g], m_Band, m_Spans);
        continue;
      }
      members[group.count] = m_Cells[g];
      this->AddToGroup(g, group);
      if (group.count == groupSize)
      {
        AddGroup(group, members);
        group.count = 0;
      }
    }
    if (group.count > 0)
    {
      AddGroup(group, members);
    }
    if constexpr (N <= maximumSpanDegree)
    {
      if (m_Spans.pieces > 0)
      {
        SetRows(m_Shape, m_Band.stride, m_Spans);
        SetPixels(m_Spans);
        SetRayChords<false>(m_Shape, m_Spans, nullptr, m_Chords);
        AddListed();
      }
    }
  }

private:
  /** Of the cell to come alone: those of a block would wait for each other. */
  inline __attribute__((always_inline)) void
  FetchModes(std::int32_t cell) const
  {
    const std::size_t first = static_cast<std::size_t>(cell) * m_Run.densityStride;
    for (int m = 0; m < m_Derivatives.densityModes; ++m)
    {
      for (int p = 0; p < count + lanes - 1; p += lanes)
      {
        __builtin_prefetch(m_Derivatives.density[m] + first + p);
      }
    }
  }
  void
  AddGroup(CellGroup & group, const std::int32_t * members) const
  {
    Complete(group);
    GroupFrame groupFrame;
    SetGroupFrame(group, groupFrame);
    const FrameSteps steps = StepsOf(groupFrame, group.parallel);
    GroupDensity<N>  density;
    density.Set(group, groupFrame, steps.perX, steps.perY);
    const auto add = [&](const auto real, int member, const Frame & frame) {
      using Real = std::decay_t<decltype(real)>;
      using Lanes = typename TermVector<Real>::Type;
      const RayTerms<Real, N> rays(groupFrame, frame, steps, density, member, group.parallel);
      ModeAdder<N>            adder(m_Run, m_Derivatives, m_Band, members[member], groupFrame.halfDepth[member]);
      PixelList<Real>         pixels;
      ForEachPixelList(frame, m_Band, pixels, [&](const PixelList<Real> & list) {
        TermList<count>       basis;
        TermList<vertexTerms> vertex;
        for (int i = 0; i < list.count; i += TermVector<Real>::size)
        {
          Lanes xi, eta;
          __builtin_memcpy(&xi, list.xi + i, sizeof(xi));
          __builtin_memcpy(&eta, list.eta + i, sizeof(eta));
          rays.Make(
            xi,
            eta,
            Lanes{} == Lanes{},
            m_Derivatives.vertexBlocks > 0,
            [&](int p, const Lanes & value) __attribute__((always_inline)) { StoreRounded(value, basis.of[p] + i); },
            [&](int q, const Lanes & value) __attribute__((always_inline)) { StoreRounded(value, vertex.of[q] + i); });
        }
        adder.Add(basis, vertex, list.at, list.count);
      });
    };
    ForEachSeen(group, groupFrame, m_Band, [&](int member, const Frame & frame, bool exact) {
      exact ? add(double(), member, frame) : add(float(), member, frame);
    });
  }

  /** The cells of the list, one after another. */
  void
  AddListed()
  {
    const BlockCoordinates coordinates(m_Frames);
    SetGradients();
    for (int piece = 0, row = 0; piece < m_Spans.pieces;)
    {
      const int g = m_Spans.piece[piece].cell, first = m_Spans.from[row];
      while (piece < m_Spans.pieces && m_Spans.piece[piece].cell == g)
      {
        row += m_Spans.piece[piece++].rows;
      }
      if (piece < m_Spans.pieces)
      {
        FetchModes(m_Cells[m_Spans.piece[piece].cell]);
      }
      const int end = m_Spans.from[row - 1] + m_Spans.count[row - 1];
      if (end > first)
      {
        AddCell(coordinates, g, first, end);
      }
    }
  }
  void
  AddCell(const BlockCoordinates & coordinates, int g, int first, int end)
  {
    ModeAdder<N>             adder(m_Run, m_Derivatives, m_Band, m_Cells[g], m_Frames.halfDepth[g]);
    TermList<count>          basis;
    TermList<vertexTerms>    vertex;
    alignas(64) std::int32_t at[listSize];
    const PixelBox           box = this->BoxOf(g);
    const int                stride = static_cast<int>(m_Band.stride);
    const int                out = (box.firstRow - m_Band.firstRow) * stride + box.firstColumn - m_Band.firstColumn;
    for (int start = first; start < end; start += listSize)
    {
      const int pixels = end - start < listSize ? end - start : listSize;
      for (int i = 0; i < pixels; i += tileLanes)
      {
        const TileIndex place = __builtin_convertvector(LoadVector<TilePlaces>(m_Spans.place + start + i), TileIndex);
        StoreVector(at + i, (place >> 8) * stride + (place & 255) + out);
        SetTerms(coordinates, g, (start + i) / tileLanes, i, basis, vertex);
      }
      adder.Add(basis, vertex, at, pixels);
    }
  }
  /** Of a tile, to place `to` of the lists. */
  inline __attribute__((always_inline)) void
  SetTerms(const BlockCoordinates & coordinates,
           int                      g,
           int                      tile,
           int                      to,
           TermList<count> &        basis,
           TermList<vertexTerms> &  vertex) const
  {
    const Tile c = m_Chords.column[tile], r = m_Chords.row[tile], z = m_Chords.z[tile], length = m_Chords.half[tile];
    const Tile magnification = 1 + m_Shape.kappa[g] * z, x = magnification * c, y = magnification * r;
    const Tile perX = m_Shape.kappa[g] * c, perY = m_Shape.kappa[g] * r;
    Tile       middle[4], half[4];
    Repeat<4>([&](int i) __attribute__((always_inline)) {
      const auto of = [&](int axis) __attribute__((always_inline))
      {
        return coordinates.mu[axis][i][g];
      };
      middle[i] = of(0) + of(1) * x + of(2) * y + of(3) * z;
      half[i] = length * (of(3) + of(1) * perX + of(2) * perY);
    });
    SetProductMeans<N>(
      middle, half, 2 * length, [&](int p, const Tile & value) __attribute__((always_inline)) {
        StoreVector(basis.of[p] + to, value);
      });
    if (m_Derivatives.vertexBlocks > 0)
    {
      SetVertexTerms(g, tile, to, middle, half, vertex);
    }
  }
  inline __attribute__((always_inline)) void
  SetVertexTerms(int g,
                 int tile,
                 int to,
                 const Tile (&middle)[4],
                 const Tile (&half)[4],
                 TermList<vertexTerms> & vertex) const
  {
    const float * const q = reinterpret_cast<const float *>(m_Monomials.q) + g;
    const float         kappa = m_Shape.kappa[g];
    const Tile          zero{}, c = m_Chords.column[tile], r = m_Chords.row[tile];
    const Tile          z = m_Chords.z[tile], length = m_Chords.half[tile];
    // Where the ray enters and leaves, and the derivative's even and odd part in between.
    Tile even[3] = {}, odd[3] = {};
    if constexpr (N > 0)
    {
      constexpr float at = 0.57735026918962576f;
      const auto      rates = [&](const Tile & z1, Tile(&values)[3]) __attribute__((always_inline))
      {
        const Tile magnification = 1 + kappa * z1, x = magnification * c, y = magnification * r;
        Repeat<3>([&](int axis) __attribute__((always_inline)) {
          values[axis] = ValueAt<N - 1>(reinterpret_cast<const float *>(m_Gradients[axis].q) + g, x, y, z1);
        });
      };
      Tile near[3], far[3];
      rates(z - at * length, near);
      rates(z + at * length, far);
      Repeat<3>([&](int axis) __attribute__((always_inline)) {
        even[axis] = length * (near[axis] + far[axis]);
        odd[axis] = at * length * (far[axis] - near[axis]);
      });
    }
    const Tile      nearer = 1 + kappa * (z - length), farther = 1 + kappa * (z + length);
    const Tile      first = ValueAt<N>(q, nearer * c, nearer * r, z - length);
    const Tile      last = ValueAt<N>(q, farther * c, farther * r, z + length);
    const TileIndex in = m_Chords.entry[tile], out = m_Chords.exit[tile];
    const Tile      start = in >= 0 ? first : zero, end = in >= 0 ? last : zero;
    // Exact up to degree 3: the mean of the ends less a third of the difference of the slopes at the Gauss points.
    const Tile mean = 0.5f * (start + end - odd[2] - kappa * (c * odd[0] + r * odd[1]));
    const auto met = [&](const TileIndex & plane, int other, int axis) __attribute__((always_inline))
    {
      const auto of = [&](int p) __attribute__((always_inline))
      {
        return zero + m_Shape.depth[p][axis][g];
      };
      return plane == 1 ? of(1) : (plane == 2 ? of(2) : of(other));
    };
    const Tile entering = start * nearer, leaving = end * farther;
    Tile       byMiddle[2], byHalf[2];
    Repeat<2>([&](int axis) __attribute__((always_inline)) {
      const Tile into = entering * met(in, 0, axis + 1), from = leaving * met(out, 3, axis + 1);
      byMiddle[axis] = m_Steps[axis][g] * (from - into - even[axis]);
      byHalf[axis] = m_Steps[axis][g] * (from + into - odd[axis]);
    });
    const float spread = m_Run.parallel ? 0.0f : 1.0f;
    const Tile  column = m_Centre[0][g] + spread * c, row = m_Centre[1][g] + spread * r;
    const Tile  stretch = (2.0f * m_PerDepth[g]) * mean;
    Repeat<4>([&](int i) __attribute__((always_inline)) {
      const Tile byX = middle[i] * byMiddle[0] + half[i] * byHalf[0];
      const Tile byY = middle[i] * byMiddle[1] + half[i] * byHalf[1];
      StoreVector(vertex.of[3 * i] + to, stretch * half[i] - column * byX - row * byY);
      StoreVector(vertex.of[3 * i + 1] + to, byX);
      StoreVector(vertex.of[3 * i + 2] + to, byY);
    });
  }
  /** The density's derivatives by X, Y and z, and what turns derivatives by X and Y into those by column s and row s.
   */
  void
  SetGradients()
  {
    const Octet none{}, away = m_Run.parallel ? none + 1.0 : m_Frames.s0;
    m_Steps[0] = m_Steps[1] = Narrow(1.0 / away);
    m_Centre[0] = Narrow(m_Run.parallel ? none : m_Frames.c0);
    m_Centre[1] = Narrow(m_Run.parallel ? none : m_Frames.r0);
    m_PerDepth = Narrow(1.0 / m_Frames.halfDepth);
    if constexpr (N > 0)
    {
      for (int a = 0; a < N; ++a)
      {
        for (int b = 0; a + b < N; ++b)
        {
          for (int k = 0; a + b + k < N; ++k)
          {
            m_Gradients[0].q[a][b][k] = static_cast<float>(a + 1) * m_Monomials.q[a + 1][b][k];
            m_Gradients[1].q[a][b][k] = static_cast<float>(b + 1) * m_Monomials.q[a][b + 1][k];
            m_Gradients[2].q[a][b][k] = static_cast<float>(k + 1) * m_Monomials.q[a][b][k + 1];
          }
        }
      }
    }
  }

  using BlockSetup<N>::m_Run;
  using BlockSetup<N>::m_Band;
  using BlockSetup<N>::m_Cells;
  using BlockSetup<N>::m_Frames;
  using BlockSetup<N>::m_Shape;
  using BlockSetup<N>::m_Spans;
  using BlockSetup<N>::m_Monomials;
  using BlockSetup<N>::m_Seen;
  using BlockSetup<N>::m_Exact;
  using BlockSetup<N>::m_Fine;

  const Derivatives &                   m_Derivatives;
  RayChords                             m_Chords;
  Monomials<(N > 0 ? N - 1 : 0), Batch> m_Gradients[3];
  Batch                                 m_Steps[2], m_Centre[2], m_PerDepth;
};

template <int N>
void
DeriveOfDegree(const BlockRun & run, const Derivatives & derivatives, const Band & band)
{
  BlockDeriver<N> deriver(run, derivatives, band);
  for (std::size_t i = 0; i < run.count; ++i)
  {
    deriver.Add(static_cast<std::size_t>(run.blocks[i]),
                static_cast<std::size_t>(run.blocks[i + 1 < run.count ? i + 1 : i]));
  }
}

inline void
DeriveBlocks(const BlockRun & run, const Derivatives & derivatives, const Band & band)
{
  using Function = void (*)(const BlockRun &, const Derivatives &, const Band &);
  constexpr Function byDegree[] = { DeriveOfDegree<0>, DeriveOfDegree<1>, DeriveOfDegree<2>,
                                    DeriveOfDegree<3>, DeriveOfDegree<4>, DeriveOfDegree<5>,
                                    DeriveOfDegree<6>, DeriveOfDegree<7>, DeriveOfDegree<8> };
  byDegree[run.degree](run, derivatives, band);
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
