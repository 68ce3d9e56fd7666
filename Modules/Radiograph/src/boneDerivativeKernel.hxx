/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Derivatives of the projection. Those of a pixel are sums over its terms (boneRayTerms.hxx) for all modes at once.

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

/** Eight modes of a member, coefficients [start, start + TCount): to half of the table's blocks. */
template <int TCount>
inline __attribute__((always_inline)) void
SetTablePart(const double * const (&from)[lanes], int start, Modes * to, int part)
{
  Batch rows[lanes], columns[lanes];
  for (int m = 0; m < lanes; ++m)
  {
    rows[m] = LoadRounded<TCount>(from[m] + start);
  }
  TransposeBlock(rows, columns);
  for (int k = 0; k < TCount; ++k)
  {
    __builtin_memcpy(reinterpret_cast<float *>(to + start + k) + part, columns + k, sizeof(Batch));
  }
}

/** Block of density modes (the density itself being the first) of a member. */
template <int N>
inline void
SetDensityTable(const CellGroup &                group,
                const Derivatives &              derivatives,
                int                              member,
                double                           halfDepth,
                int                              block,
                ModeTable<CoefficientCount(N)> & table)
{
  constexpr int           count = CoefficientCount(N), whole = count / lanes, left = count % lanes;
  static constexpr double none[count] = {};
  for (int part = 0; part < modeLanes; part += lanes)
  {
    const double * from[lanes];
    for (int m = 0; m < lanes; ++m)
    {
      const int mode = block * modeLanes + part + m;
      from[m] = mode < derivatives.densityModes ? derivatives.density[mode] + derivatives.coefficient[member] : none;
    }
    RepeatLow<N, whole>([&](int piece)
                          __attribute__((always_inline)) { SetTablePart<lanes>(from, piece * lanes, table.of, part); });
    if constexpr (left > 0)
    {
      SetTablePart<left>(from, whole * lanes, table.of, part);
    }
  }
  const auto scale = static_cast<float>(halfDepth * group.scale);
  Modes      offset{};
  offset[0] = block == 0 ? static_cast<float>(halfDepth * group.offset) : 0.0f;
  RepeatLow<N, count>([&](int p) __attribute__((always_inline)) {
    table.of[p] = static_cast<float>(basisFactors<N>.of[p]) * (scale * table.of[p] + offset);
  });
}

/** Block of displacements of a member's vertices. */
inline void
SetVertexTable(const Derivatives & derivatives, int member, int block, ModeTable<vertexTerms> & table)
{
  const int stride = derivatives.vertexBlocks * modeLanes;
  Repeat<vertexTerms>([&](int q) __attribute__((always_inline)) {
    const float * const from = derivatives.displacement[member][q / 3] + q % 3 * stride + block * modeLanes;
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

/** Adds a cell's integrals and derivatives. */
template <typename TReal, int N>
class ModeAdder
{
public:
  static constexpr int count = CoefficientCount(N);

  ModeAdder(const CellGroup & group, const Derivatives & derivatives, const Band & band, int member, double halfDepth)
    : m_Group(group)
    , m_Derivatives(derivatives)
    , m_Band(band)
    , m_Member(member)
    , m_HalfDepth(halfDepth)
  {
    // Mostly there is one block of each, which is set up once.
    SetDensityTable<N>(group, derivatives, member, halfDepth, 0, m_Density);
    if (derivatives.vertexBlocks > 0)
    {
      SetVertexTable(derivatives, member, 0, m_Vertex);
    }
  }

  void
  Add(const RayTerms<TReal, N> & rays, const PixelList<TReal> & list)
  {
    using Lanes = typename TermVector<TReal>::Type;
    TermList<vertexTerms> vertex;
    TermList<count>       basis;
    const bool            withVertices = m_Derivatives.vertexBlocks > 0;
    for (int i = 0; i < list.count; i += TermVector<TReal>::size)
    {
      Lanes xi, eta;
      __builtin_memcpy(&xi, list.xi + i, sizeof(xi));
      __builtin_memcpy(&eta, list.eta + i, sizeof(eta));
      rays.Make(
        xi,
        eta,
        Lanes{} == Lanes{},
        withVertices,
        [&](int p, const Lanes & value) __attribute__((always_inline)) { StoreRounded(value, basis.of[p] + i); },
        [&](int q, const Lanes & value) __attribute__((always_inline)) { StoreRounded(value, vertex.of[q] + i); });
    }
    const int plane = (m_Derivatives.vertexBlocks + m_Derivatives.densityBlocks) * modeLanes;
    float *   out = m_Band.data;
    for (int block = 0; block < m_Derivatives.vertexBlocks; ++block, out += modeLanes)
    {
      if (m_Derivatives.vertexBlocks > 1)
      {
        SetVertexTable(m_Derivatives, m_Member, block, m_Vertex);
      }
      AddBlock(m_Vertex, vertex, list.at, list.count, out, plane);
    }
    for (int block = 0; block < m_Derivatives.densityBlocks; ++block, out += modeLanes)
    {
      if (m_Derivatives.densityBlocks > 1)
      {
        SetDensityTable<N>(m_Group, m_Derivatives, m_Member, m_HalfDepth, block, m_Density);
      }
      AddBlock(m_Density, basis, list.at, list.count, out, plane);
    }
  }

private:
  const CellGroup &   m_Group;
  const Derivatives & m_Derivatives;
  const Band &        m_Band;
  int                 m_Member;
  double              m_HalfDepth;

  ModeTable<count>       m_Density;
  ModeTable<vertexTerms> m_Vertex;
};

template <int N>
inline void
PrefetchNext(const Derivatives & derivatives)
{
  for (int m = 0; m < derivatives.densityModes; ++m)
  {
    for (int g = 0; g < derivatives.nextCount; ++g)
    {
      const double * const start = derivatives.density[m] + derivatives.next[g];
      for (int p = 0; p < CoefficientCount(N) + lanes - 1; p += lanes)
      {
        __builtin_prefetch(start + p);
      }
    }
  }
}

template <int N>
void
DeriveOfDegree(CellGroup & group, const Derivatives & derivatives, const Band & band)
{
  PrefetchNext<N>(derivatives);
  GroupFrame groupFrame;
  SetGroupFrame(group, groupFrame);
  const FrameSteps steps = StepsOf(groupFrame, group.parallel);
  GroupDensity<N>  density;
  density.Set(group, groupFrame, steps.perX, steps.perY);
  const auto add = [&](const auto real, int member, const Frame & frame) {
    using Real = std::decay_t<decltype(real)>;
    const RayTerms<Real, N> rays(groupFrame, frame, steps, density, member, group.parallel);
    ModeAdder<Real, N>      adder(group, derivatives, band, member, groupFrame.halfDepth[member]);
    PixelList<Real>         pixels;
    ForEachPixelList(frame, band, pixels, [&](const PixelList<Real> & list) { adder.Add(rays, list); });
  };
  ForEachSeen(group, groupFrame, band, [&](int member, const Frame & frame, bool exact) {
    exact ? add(double(), member, frame) : add(float(), member, frame);
  });
}

inline void
DeriveCells(CellGroup & group, const Derivatives & derivatives, const Band & band)
{
  Complete(group);
  using Function = void (*)(CellGroup &, const Derivatives &, const Band &);
  constexpr Function byDegree[] = { DeriveOfDegree<0>, DeriveOfDegree<1>, DeriveOfDegree<2>,
                                    DeriveOfDegree<3>, DeriveOfDegree<4>, DeriveOfDegree<5>,
                                    DeriveOfDegree<6>, DeriveOfDegree<7>, DeriveOfDegree<8> };
  byDegree[group.degree](group, derivatives, band);
}

} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
