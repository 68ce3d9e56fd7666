/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The adjoint of the projection: sums over the pixels of a cell, weighted by an image. It is compiled like
// boneProjectionKernel.hxx, which describes a cell's frame.
//
// With mu_j the barycentric coordinates, the derivatives of a cell's integrals by its coefficients are the sums S of
// the integrals of products of mu_j. Those by a displacement u_j of vertex j along an axis A of X, Y, z are
//   - sum of integral (d rho / dA) mu_j dz + sum of rho mu_j (d mu_f / dA) / (d mu_f / dz along the ray), exit less
//   entry,
// f the face that is met. The first sum is linear in the S: it is taken once a cell, not at each pixel. In the second
// d mu_f / dz = -slope_f (1 + kappa v), and (1 + kappa v) mu_j on a face is affine in the pixel: three numbers a face
// are summed. A pixel thus adds to 20 sums (degree 3) of one face each where it enters and leaves, whatever derivatives
// are wanted. Cells that spans do not suit take boneRayTerms.hxx.

#include "boneRayChords.hxx"
#include "boneRayTerms.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
template <typename TLanes>
inline double
Sum(const TLanes & values)
{
  double sum = 0;
  for (std::size_t i = 0; i < sizeof(values) / sizeof(values[0]); ++i)
  {
    sum += values[i];
  }
  return sum;
}

/** Sums a cell's terms times the band's weights over the pixels. */
template <typename TReal, int N>
class TermSummer
{
public:
  using Lanes = typename TermVector<TReal>::Type;
  static constexpr int count = CoefficientCount(N);

  TermSummer(const Band & band, bool withVertices)
    : m_Band(band)
    , m_WithVertices(withVertices)
  {}

  void
  Add(const RayTerms<TReal, N> & rays, const PixelList<TReal> & list)
  {
    TReal weights[listSize + TermVector<TReal>::size];
    for (int i = 0; i < list.count; ++i)
    {
      weights[i] = m_Band.data[list.at[i]];
    }
    for (int i = list.count; i < list.count + TermVector<TReal>::size; ++i)
    {
      weights[i] = 0;
    }
    for (int i = 0; i < list.count; i += TermVector<TReal>::size)
    {
      Lanes xi, eta, weight;
      __builtin_memcpy(&xi, list.xi + i, sizeof(xi));
      __builtin_memcpy(&eta, list.eta + i, sizeof(eta));
      __builtin_memcpy(&weight, weights + i, sizeof(weight));
      rays.Make(
        xi,
        eta,
        weight != 0,
        m_WithVertices,
        [&](int p, const Lanes & value) __attribute__((always_inline)) { m_Basis[p] += weight * value; },
        [&](int q, const Lanes & value) __attribute__((always_inline)) { m_Vertex[q] += weight * value; });
    }
  }
  /** `scale`: of the coefficients. */
  void
  Write(double scale, const BlockRun & run, double * coefficients, double * positions) const
  {
    for (int p = 0; p < count; ++p)
    {
      coefficients[p] = scale * basisFactors<N>.of[p] * Sum(m_Basis[p]);
    }
    for (int i = 0; m_WithVertices && i < 4; ++i)
    {
      for (int k = 0; k < 3; ++k)
      {
        positions[3 * i + k] = 0;
        for (int axis = 0; axis < 3; ++axis)
        {
          positions[3 * i + k] += run.toPixel[axis][k] * Sum(m_Vertex[3 * i + axis]);
        }
      }
    }
  }

private:
  const Band & m_Band;
  bool         m_WithVertices;
  Lanes        m_Basis[count] = {};
  Lanes        m_Vertex[vertexTerms] = {};
};

/** Reads the image at the pixels of the list. */
inline __attribute__((always_inline)) void
ReadWeights(const SpanList & list, const Band & band, float * weights)
{
  const Tile      zero{};
  const TileIndex index = __builtin_convertvector(TileLanes(), TileIndex);
  for (int i = 0; i < list.pixels; i += tileLanes)
  {
    StoreVector(weights + i, zero);
  }
  for (int row = 0; row < list.rows; ++row)
  {
    StoreVector(weights + list.from[row], index < list.count[row] ? LoadVector<Tile>(band.data + list.out[row]) : zero);
  }
}

/** The sums of a block's cells. */
template <int N>
struct BlockSums
{
  static constexpr int count = CoefficientCount(N), ends = 12, size = (count + ends + lanes - 1) / lanes * lanes;

  alignas(64) float of[lanes][size]; ///< of each cell: of products, then, by face, of what ends there add: times 1,
                                     ///< column, row
};

/** Where the product of the edges' coordinates with these exponents stands in an expansion. */
constexpr int
PlaceOf(int first, int second, int third)
{
  const int l = third, kl = second + l, jkl = first + kl;
  return jkl * (jkl + 1) * (jkl + 2) / 6 + kl * (kl + 1) / 2 + l;
}

/** The products of two and of three of the edges' coordinates. */
struct EdgeProducts
{
  int pair[3][3]{};   ///< number of the product
  int pairPlace[6]{}; ///< in an expansion
  int pairOf[6][2]{}; ///< its factors
  int triplePlace[10]{};
  int tripleOf[10][2]{}; ///< one factor, and the pair of the others
  constexpr EdgeProducts()
  {
    int pairs = 0, triples = 0;
    for (int i = 0; i < 3; ++i)
    {
      for (int j = i; j < 3; ++j, ++pairs)
      {
        pair[i][j] = pair[j][i] = pairs;
        pairOf[pairs][0] = i;
        pairOf[pairs][1] = j;
        pairPlace[pairs] = Place(i, j, -1);
      }
    }
    for (int i = 0; i < 3; ++i)
    {
      for (int j = i; j < 3; ++j)
      {
        for (int k = j; k < 3; ++k, ++triples)
        {
          tripleOf[triples][0] = i;
          tripleOf[triples][1] = pair[j][k];
          triplePlace[triples] = Place(i, j, k);
        }
      }
    }
  }
  static constexpr int
  Place(int i, int j, int k)
  {
    const auto exponent = [&](int edge) { return (i == edge ? 1 : 0) + (j == edge ? 1 : 0) + (k == edge ? 1 : 0); };
    return PlaceOf(exponent(0), exponent(1), exponent(2));
  }
};
constexpr EdgeProducts edgeProducts;

/** A block's coordinates of edges (bonePowerKernel.hxx), per column and row
 * at the centroid, and per z. */
struct BlockEdges
{
  Batch per[3][3]; ///< [axis][edge]

  explicit BlockEdges(const Frames<Octet> & frames)
  {
    for (int i = 0; i < 3; ++i)
    {
      per[0][i] = Narrow(frames.mu[1][i + 1] * frames.perWidth);
      per[1][i] = Narrow(frames.mu[2][i + 1] * frames.perHeight);
      per[2][i] = Narrow(frames.mu[3][i + 1]);
    }
  }
};

/** Adds weight times the means of all products of up to N of the edges' coordinates along chords with middles `middle`
 * and half differences `half`, as two Gauss points give them: a product of two is even + odd, the part that is the same
 * at both points and that which changes its sign. */
template <int N>
inline __attribute__((always_inline)) void
AddMoments(const Tile (&middle)[3], const Tile (&half)[3], const Tile & weight, Tile * sums)
{
  static_assert(N <= 3, "two points are exact up to degree 3");
  constexpr float third = 1.0f / 3;
  sums[0] += weight;
  if constexpr (N >= 1)
  {
    Tile weighed[3], step[3], even[6];
    Repeat<3>([&](int i) __attribute__((always_inline)) {
      weighed[i] = weight * middle[i];
      step[i] = third * half[i];
      sums[1 + i] += weighed[i];
    });
    if constexpr (N >= 2)
    {
      Repeat<6>([&](int q) __attribute__((always_inline)) {
        const int i = edgeProducts.pairOf[q][0], j = edgeProducts.pairOf[q][1];
        even[q] = middle[i] * middle[j] + step[i] * half[j];
        sums[edgeProducts.pairPlace[q]] += weight * even[q];
      });
    }
    if constexpr (N >= 3)
    {
      Tile odd[6];
      Repeat<6>([&](int q) __attribute__((always_inline)) {
        const int i = edgeProducts.pairOf[q][0], j = edgeProducts.pairOf[q][1];
        odd[q] = middle[i] * half[j] + half[i] * middle[j];
      });
      Repeat<3>([&](int i) __attribute__((always_inline)) { step[i] *= weight; });
      Repeat<10>([&](int q) __attribute__((always_inline)) {
        const int i = edgeProducts.tripleOf[q][0], pair = edgeProducts.tripleOf[q][1];
        sums[edgeProducts.triplePlace[q]] += weighed[i] * even[pair] + step[i] * odd[pair];
      });
    }
  }
}

/** Folds a vector of pixels to eight. */
inline Batch
Fold(const Tile & values)
{
#if BONE_PROJECTION_TILE_ROWS > 1
  return __builtin_shufflevector(values, values, 0, 1, 2, 3, 4, 5, 6, 7) +
         __builtin_shufflevector(values, values, 8, 9, 10, 11, 12, 13, 14, 15);
#else
  return values;
#endif
}

/** The sum of each of some vectors. */
template <int TSize>
inline __attribute__((always_inline)) void
SumLanes(const Tile (&values)[TSize], float * sums)
{
  static_assert(TSize % lanes == 0, "whole batches");
  for (int start = 0; start < TSize; start += lanes)
  {
    Batch rows[lanes], columns[lanes];
    for (int i = 0; i < lanes; ++i)
    {
      rows[i] = Fold(values[start + i]);
    }
    TransposeBlock(rows, columns);
    StoreVector(sums + start,
                ((columns[0] + columns[1]) + (columns[2] + columns[3])) +
                  ((columns[4] + columns[5]) + (columns[6] + columns[7])));
  }
}

/** Sums over blocks of one degree. */
template <int N>
class BlockAdjoiner : private BlockSetup<N>
{
public:
  static constexpr int count = CoefficientCount(N), lower = LowerCount(N);

  BlockAdjoiner(const BlockRun & run, const Adjoint & adjoint, const Band & band)
    : BlockSetup<N>(run, band)
    , m_Adjoint(adjoint)
  {}

  /** `next`: the block to come. */
  void
  Set(std::size_t block, std::size_t next)
  {
    this->SetBlock(block, next);
    m_Block = block;
    BatchIndex inSpans{};
    CellGroup  group;
    group.count = 0;
    group.degree = N;
    group.scale = m_Run.scale;
    group.offset = m_Run.offset;
    group.parallel = m_Run.parallel;
    int members[groupSize];
    Fetch(next);
    const BatchIndex precise = m_Exact | m_Fine | this->FindFarReaching();
    for (int g = 0; g < lanes && m_Cells[g] >= 0; ++g)
    {
      const PixelBox box = this->BoxOf(g);
      if (m_Seen[g] == 0)
      {
        Clear(m_Cells[g]);
      }
      else if (N <= maximumSpanDegree && precise[g] == 0 && FitsSpans(box))
      {
        AddToSpans(g, box, m_Frames.c0[g], m_Frames.r0[g], m_Band, m_Spans);
        inSpans[g] = -1;
      }
      else
      {
        members[group.count] = m_Cells[g];
        this->AddToGroup(g, group);
        if (group.count == groupSize)
        {
          SetGroup(group, members);
          group.count = 0;
        }
      }
    }
    if (group.count > 0)
    {
      SetGroup(group, members);
    }
    if constexpr (N <= maximumSpanDegree)
    {
      if (m_Spans.pieces == 0)
      {
        return;
      }
      SetRows(m_Shape, m_Band.stride, m_Spans);
      SetPixels(m_Spans);
      ReadWeights(m_Spans, m_Band, m_Weights);
      SetRayChords<true>(m_Shape, m_Spans, m_Weights, m_Chords);
      SumSpans();
      WriteSums(inSpans);
    }
  }

private:
  /** What is written of the cells of a block to come. */
  inline __attribute__((always_inline)) void
  Fetch(std::size_t block) const
  {
    const std::int32_t * const cells = m_Run.cells + block * lanes;
    constexpr int              line = 8;
    for (int g = 0; g < lanes && cells[g] >= 0; ++g)
    {
      for (int p = 0; p < count + line - 1; p += line)
      {
        __builtin_prefetch(CoefficientsOf(cells[g]) + p, 1);
      }
    }
  }
  double *
  CoefficientsOf(std::int32_t cell) const
  {
    return m_Adjoint.coefficients + static_cast<std::size_t>(cell) * m_Run.densityStride;
  }
  double *
  PositionsOf(std::int32_t cell) const
  {
    return m_Adjoint.positions == nullptr ? nullptr : m_Adjoint.positions + 12 * static_cast<std::size_t>(cell);
  }
  void
  Clear(std::int32_t cell) const
  {
    for (int p = 0; p < count; ++p)
    {
      CoefficientsOf(cell)[p] = 0;
    }
    for (int q = 0; m_Adjoint.positions != nullptr && q < 12; ++q)
    {
      PositionsOf(cell)[q] = 0;
    }
  }

  void
  SetGroup(CellGroup & group, const int * members) const
  {
    Complete(group);
    GroupFrame groupFrame;
    SetGroupFrame(group, groupFrame);
    const FrameSteps steps = StepsOf(groupFrame, group.parallel);
    GroupDensity<N>  density;
    density.Set(group, groupFrame, steps.perX, steps.perY);
    const auto sum = [&](const auto real, int member, const Frame & frame) {
      using Real = std::decay_t<decltype(real)>;
      const RayTerms<Real, N> rays(groupFrame, frame, steps, density, member, group.parallel);
      TermSummer<Real, N>     summer(m_Band, m_Adjoint.positions != nullptr);
      PixelList<Real>         pixels;
      ForEachPixelList(frame, m_Band, pixels, [&](const PixelList<Real> & list) { summer.Add(rays, list); });
      const std::int32_t cell = members[member];
      summer.Write(groupFrame.halfDepth[member] * m_Run.scale, m_Run, CoefficientsOf(cell), PositionsOf(cell));
    };
    for (int member = 0; member < group.count; ++member)
    {
      Clear(members[member]);
    }
    ForEachSeen(group, groupFrame, m_Band, [&](int member, const Frame & frame, bool exact) {
      exact ? sum(double(), member, frame) : sum(float(), member, frame);
    });
  }

  void
  SumSpans()
  {
    const BlockEdges edges(m_Frames);
    const int        tiles = (m_Spans.pixels + tileLanes - 1) / tileLanes;
    __builtin_memset(&m_Sums, 0, sizeof(m_Sums)); // a cell between the pixels has no tile
    for (int tile = 0; tile < tiles;)
    {
      const int g = m_Spans.cellOf[tile], first = tile;
      while (tile < tiles && m_Spans.cellOf[tile] == g)
      {
        ++tile;
      }
      Tile sums[BlockSums<N>::size] = {};
      SumMoments(edges, g, first, tile, sums);
      if (m_Adjoint.positions != nullptr)
      {
        SumEnds(g, first, tile, sums);
      }
      SumLanes(sums, m_Sums.of[g]);
      float byPlane[12];
      __builtin_memcpy(byPlane, m_Sums.of[g] + count, sizeof(byPlane));
      for (int p = 0; p < 4; ++p)
      {
        __builtin_memcpy(m_Sums.of[g] + count + 3 * m_Shape.face[p][g], byPlane + 3 * p, 3 * sizeof(float));
      }
    }
  }
  inline __attribute__((always_inline)) void
  SumMoments(const BlockEdges & edges, int g, int first, int end, Tile (&sums)[BlockSums<N>::size]) const
  {
    const float kappa = m_Shape.kappa[g];
    for (int tile = first; tile < end; ++tile)
    {
      const Tile c = m_Chords.column[tile], r = m_Chords.row[tile], z = m_Chords.z[tile];
      const Tile halfLength = m_Chords.half[tile], magnification = 1 + kappa * z;
      const Tile x = magnification * c, y = magnification * r, perX = kappa * c, perY = kappa * r;
      Tile       middle[3], half[3];
      Repeat<3>([&](int i) __attribute__((always_inline)) {
        const auto per = [&](int axis) __attribute__((always_inline))
        {
          return edges.per[axis][i][g];
        };
        middle[i] = per(0) * x + per(1) * y + per(2) * z;
        half[i] = halfLength * (per(2) + per(0) * perX + per(1) * perY);
      });
      const Tile weight = LoadVector<Tile>(m_Weights + tile * tileLanes);
      AddMoments<N>(middle, half, weight * (2 * halfLength), sums);
    }
  }
  inline __attribute__((always_inline)) void
  SumEnds(int g, int first, int end, Tile (&sums)[BlockSums<N>::size]) const
  {
    const float * const q = reinterpret_cast<const float *>(m_Monomials.q) + g;
    const float         kappa = m_Shape.kappa[g];
    const Tile          zero{};
    for (int tile = first; tile < end; ++tile)
    {
      const Tile weight = LoadVector<Tile>(m_Weights + tile * tileLanes);
      const Tile c = m_Chords.column[tile], r = m_Chords.row[tile];
      const auto at = [&](const Tile & z) __attribute__((always_inline))
      {
        const Tile magnification = 1 + kappa * z;
        return weight * (magnification * magnification) * ValueAt<N>(q, magnification * c, magnification * r, z);
      };
      const Tile in = at(m_Chords.z[tile] - m_Chords.half[tile]);
      const Tile out = at(m_Chords.z[tile] + m_Chords.half[tile]);
      Repeat<4>([&](int p) __attribute__((always_inline)) {
        const Tile value = (m_Chords.entry[tile] == p ? in : zero) + (m_Chords.exit[tile] == p ? out : zero);
        sums[count + 3 * p] += value;
        sums[count + 3 * p + 1] += value * c;
        sums[count + 3 * p + 2] += value * r;
      });
    }
  }

  /** From the sums of all cells to their derivatives. */
  void
  WriteSums(const BatchIndex & inSpans) const
  {
    Octet sums[BlockSums<N>::size], positions[12];
    for (int start = 0; start < BlockSums<N>::size; start += lanes)
    {
      Batch rows[lanes], columns[lanes];
      for (int g = 0; g < lanes; ++g)
      {
        rows[g] = LoadVector<Batch>(m_Sums.of[g] + start);
      }
      TransposeBlock(rows, columns);
      for (int p = 0; p < lanes; ++p)
      {
        sums[start + p] = __builtin_convertvector(columns[p], Octet);
      }
    }
    const bool withPositions = m_Adjoint.positions != nullptr;
    if (withPositions)
    {
      SetPositions(sums, positions);
    }
    Octet       coefficients[count];
    const Octet scale = m_Run.scale * m_Frames.halfDepth;
    Repeat<count>([&](int p)
                    __attribute__((always_inline)) { sums[p] *= scale * layerFactors<maximumSpanDegree>.of[p]; });
    CollectLayers<N>(sums, coefficients);
    for (int g = 0; g < lanes; ++g)
    {
      for (int p = 0; inSpans[g] != 0 && p < count; ++p)
      {
        CoefficientsOf(m_Cells[g])[p] = coefficients[p][g];
      }
      for (int q = 0; withPositions && inSpans[g] != 0 && q < 12; ++q)
      {
        PositionsOf(m_Cells[g])[q] = positions[q][g];
      }
    }
  }
  void
  SetPositions(const Octet * sums, Octet (&positions)[12]) const
  {
    const Octet none{};
    const Octet away = m_Run.parallel ? none + 1.0 : m_Frames.s0;
    const Octet steps[3] = { m_Frames.perWidth / away, m_Frames.perHeight / away, none + 1.0 };
    Octet       by[4][3] = {}; // of each vertex: by column s, row s (parallel beam: column, row) and z
    AddInside(sums, steps, by);
    AddFaces(sums + count, steps, by);
    const Octet column = m_Run.parallel ? none : m_Frames.c0, row = m_Run.parallel ? none : m_Frames.r0;
    for (int i = 0; i < 4; ++i)
    {
      const Octet byS = by[i][2] / m_Frames.halfDepth - column * by[i][0] - row * by[i][1];
      for (int k = 0; k < 3; ++k)
      {
        positions[3 * i + k] =
          m_Run.toPixel[0][k] * byS + m_Run.toPixel[1][k] * by[i][0] + m_Run.toPixel[2][k] * by[i][1];
      }
    }
  }
  /** As the density moves with the tetrahedron. */
  void
  AddInside(const Octet * moments, const Octet (&steps)[3], Octet (&by)[4][3]) const
  {
    if constexpr (N > 0)
    {
      const float * const from = m_Run.coefficients + m_Block * (count + 1) * lanes;
      Octet               expansion[count];
      Repeat<count>([&](int p) __attribute__((always_inline)) {
        expansion[p] = m_Frames.halfDepth * __builtin_convertvector(LoadVector<Batch>(from + p * lanes), Octet);
      });
      for (int edge = 0; edge < 3; ++edge)
      {
        // Integrals of the derivative by the edge's coordinate: times 1 and times each edge's coordinate.
        Octet sums[4] = {};
        AddRates(expansion, moments, edge, sums);
        Octet ofVertex[4] = { sums[0], 0.25 * sums[0] + sums[1], 0.25 * sums[0] + sums[2], 0.25 * sums[0] + sums[3] };
        ofVertex[0] -= ofVertex[1] + ofVertex[2] + ofVertex[3];
        for (int axis = 0; axis < 3; ++axis)
        {
          const Octet per = steps[axis] * m_Frames.mu[axis + 1][edge + 1];
          for (int j = 0; j < 4; ++j)
          {
            by[j][axis] -= per * ofVertex[j];
          }
        }
      }
    }
  }
  static inline __attribute__((always_inline)) void
  AddRates(const Octet (&expansion)[count], const Octet * moments, int edge, Octet (&sums)[4])
  {
    // d / d e_edge of T_d(e, ..., e) is d T_d(edge, e, ..., e).
    const auto add = [&](const Octet & rate, int i, int j) __attribute__((always_inline))
    {
      sums[0] += rate * moments[EdgeProducts::Place(i, j, -1)];
      for (int k = 0; k < 3; ++k)
      {
        sums[1 + k] += rate * moments[EdgeProducts::Place(i, j, k)];
      }
    };
    add(expansion[EdgeProducts::Place(edge, -1, -1)], -1, -1);
    for (int i = 0; N >= 2 && i < 3; ++i)
    {
      add(2.0 * expansion[EdgeProducts::Place(edge, i, -1)], i, -1);
      for (int j = i; N >= 3 && j < 3; ++j)
      {
        add((i == j ? 3.0 : 6.0) * expansion[EdgeProducts::Place(edge, i, j)], i, j);
      }
    }
  }
  /** As the faces move. */
  void
  AddFaces(const Octet * ends, const Octet (&steps)[3], Octet (&by)[4][3]) const
  {
    for (int f = 0; f < 4; ++f)
    {
      const Octet perSlope = -1.0 / Absolute(m_Frames.slope[f]);
      for (int j = 0; j < 4; ++j)
      {
        if (j == f)
        {
          continue;
        }
        const Octet(&depth)[3] = m_Frames.depth[f];
        const Octet slope = m_Frames.slope[j];
        const Octet sum = ends[3 * f] * (slope * depth[0] + m_Frames.mu[0][j]) +
                          ends[3 * f + 1] * (slope * depth[1] + m_Frames.mu[1][j] * m_Frames.perWidth) +
                          ends[3 * f + 2] * (slope * depth[2] + m_Frames.mu[2][j] * m_Frames.perHeight);
        for (int axis = 0; axis < 3; ++axis)
        {
          by[j][axis] += steps[axis] * m_Frames.mu[axis + 1][f] * perSlope * sum;
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

  const Adjoint & m_Adjoint;
  std::size_t     m_Block{ 0 };
  RayChords       m_Chords;
  alignas(64) float m_Weights[SpanList::pixelCapacity];
  BlockSums<N> m_Sums;
};

template <int N>
void
AdjoinOfDegree(const BlockRun & run, const Adjoint & adjoint, const Band & band)
{
  BlockAdjoiner<N> adjoiner(run, adjoint, band);
  for (std::size_t i = 0; i < run.count; ++i)
  {
    adjoiner.Set(static_cast<std::size_t>(run.blocks[i]),
                 static_cast<std::size_t>(run.blocks[i + 1 < run.count ? i + 1 : i]));
  }
}

inline void
AdjoinBlocks(const BlockRun & run, const Adjoint & adjoint, const Band & band)
{
  using Function = void (*)(const BlockRun &, const Adjoint &, const Band &);
  constexpr Function byDegree[] = { AdjoinOfDegree<0>, AdjoinOfDegree<1>, AdjoinOfDegree<2>,
                                    AdjoinOfDegree<3>, AdjoinOfDegree<4>, AdjoinOfDegree<5>,
                                    AdjoinOfDegree<6>, AdjoinOfDegree<7>, AdjoinOfDegree<8> };
  byDegree[run.degree](run, adjoint, band);
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
