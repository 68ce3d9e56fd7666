/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The image of the tetrahedra. It is compiled like boneProjectionKernel.hxx, which describes a cell's frame. Eight
// cells are set up at once, their geometry in double precision, their polynomials in single. Small cells then take
// spans, large ones and those of high degree strips, ill-conditioned ones rows in double precision.

#include "bonePowerKernel.hxx"
#include "boneSpanKernel.hxx"
#include "boneStripKernel.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** Smallest integer not below x >= 0. */
inline BatchIndex
RoundUp(const Octet & x)
{
  const BatchIndex down = __builtin_convertvector(x, BatchIndex);
  return down - (__builtin_convertvector(__builtin_convertvector(down, Octet) < x, BatchIndex));
}

/** Rows or columns of a range that lie in [first, end); what lies beside gets none or one. */
inline void
CutRange(const Octet (&range)[2], int first, int end, BatchIndex & from, BatchIndex & to)
{
  const Octet lowest = Octet{} + first, highest = Octet{} + (end - 1.0), beside = Octet{} + end;
  Octet       low = range[0] > lowest ? range[0] : lowest, high = range[1] < highest ? range[1] : highest;
  low = low < beside ? low : beside;
  high = high > lowest ? high : lowest;
  from = RoundUp(low);
  to = __builtin_convertvector(high, BatchIndex) + 1;
}

/** Cells of which a face is seen so nearly edge-on that its depth is less than `steep` of what it is at a right angle.
 */
inline BatchIndex
FindSteep(const Frames<Octet> & frames, double steep)
{
  BatchIndex found{};
  for (int i = 0; i < 4; ++i)
  {
    found |= ~__builtin_convertvector(Absolute(frames.slope[i]) >= steep * frames.inPlane[i], BatchIndex);
  }
  return found;
}

/** Blocks of one degree. */
template <int N>
class BlockAdder
{
public:
  BlockAdder(const BlockRun & run, const Band & band)
    : m_Run(run)
    , m_Band(band)
  {}

  /** `next`: the block to come. */
  void
  Add(std::size_t block, std::size_t next)
  {
    Fetch(next);
    SetGeometry(block);
    SetShape(m_Frames, m_Shape);
    SetPolynomials(block);
    BatchIndex firstColumn, endColumn, firstRow, endRow;
    CutRange(m_Frames.columns, m_Band.firstColumn, m_Band.columns, firstColumn, endColumn);
    CutRange(m_Frames.rows, m_Band.firstRow, m_Band.endRow, firstRow, endRow);
    // Too steep a plane, or a polynomial that grows too large, needs double precision; strips keep more of single
    // precision than spans, as they start anew in each row.
    constexpr double verySteep = 2e-3, steep = 5e-3;
    constexpr float  largestGrowth = 256;
    const BatchIndex exact = ~(m_Growth <= largestGrowth), precise = FindSteep(m_Frames, verySteep);
    const BatchIndex fine = FindSteep(m_Frames, steep);
    const BatchIndex solid = __builtin_convertvector((m_Frames.halfWidth > 0) & (m_Frames.halfHeight > 0) &
                                                       (m_Frames.halfDepth > 0) & (Absolute(m_Frames.volume) > 0),
                                                     BatchIndex);
    // With no front or no back plane it is too flat to be seen.
    const BatchIndex seen =
      solid & (firstColumn < endColumn) & (firstRow < endRow) & (m_Shape.fronts > 0) & (m_Shape.fronts < 4);
    const std::int32_t * const cells = m_Run.cells + block * lanes;
    m_Spans.Clear();
    for (int g = 0; g < lanes && cells[g] >= 0; ++g)
    {
      const PixelBox box{ firstColumn[g], endColumn[g], firstRow[g], endRow[g] };
      if (seen[g] == 0)
      {
        continue;
      }
      if (exact[g] != 0)
      {
        AddExact(cells[g], g);
      }
      else if (precise[g] != 0)
      {
        AddSteep(g);
      }
      else if (N <= maximumSpanDegree && fine[g] == 0 && FitsSpans(box))
      {
        AddToSpans(g, box, m_Frames.c0[g], m_Frames.r0[g], m_Band, m_Spans);
      }
      else
      {
        AddLarge(g, box);
      }
    }
    if constexpr (N <= maximumSpanDegree)
    {
      SetRows(m_Shape, m_Band.stride, m_Spans);
      SetPixels(m_Spans);
      IntegrateSpans<N>(m_Shape, reinterpret_cast<const float *>(m_Monomials.q), m_Spans);
      AddSpans(m_Spans, m_Band);
    }
  }

private:
  void
  Fetch(std::size_t block) const
  {
    constexpr std::size_t vertices = 12 * lanes, coefficients = (CoefficientCount(N) + 1) * lanes, line = 64;
    for (std::size_t i = 0; i < vertices; i += line / sizeof(double))
    {
      __builtin_prefetch(m_Run.vertices + block * vertices + i);
    }
    for (std::size_t i = 0; i < coefficients; i += line / sizeof(float))
    {
      __builtin_prefetch(m_Run.coefficients + block * coefficients + i);
    }
  }
  void
  SetGeometry(std::size_t block)
  {
    const double * const from = m_Run.vertices + block * 12 * lanes;
    const auto &         m = m_Run.toPixel;
    const bool           parallel = m_Run.parallel;
    Octet                sums[3] = {};
    for (int i = 0; i < 4; ++i)
    {
      Octet x[3], y[3];
      for (int k = 0; k < 3; ++k)
      {
        x[k] = LoadVector<Octet>(from + (3 * i + k) * lanes) - m_Run.origin[k];
      }
      for (int k = 0; k < 3; ++k)
      {
        y[k] = m[k][0] * x[0] + m[k][1] * x[1] + m[k][2] * x[2];
        sums[k] += y[k];
      }
      const Octet inverse = parallel ? Octet{} + 1.0 : 1.0 / y[0];
      m_Column[i] = y[1] * inverse;
      m_Row[i] = y[2] * inverse;
      m_S[i] = y[0];
    }
    // The centroid.
    const Octet inverse = parallel ? Octet{} + 0.25 : 1.0 / sums[0];
    m_Frames.c0 = sums[1] * inverse;
    m_Frames.r0 = sums[2] * inverse;
    m_Frames.s0 = 0.25 * sums[0];
    SetFrames(m_Column, m_Row, m_S, parallel, m_Frames);
  }
  void
  SetPolynomials(std::size_t block)
  {
    constexpr int       count = CoefficientCount(N);
    const float * const from = m_Run.coefficients + block * (count + 1) * lanes;
    const Batch         halfDepth = Narrow(m_Frames.halfDepth), largest = LoadVector<Batch>(from + count * lanes);
    Batch               axes[3][3], expansion[count];
    for (int i = 0; i < 3; ++i)
    {
      axes[0][i] = Narrow(m_Frames.mu[1][i + 1] * m_Frames.perWidth);
      axes[1][i] = Narrow(m_Frames.mu[2][i + 1] * m_Frames.perHeight);
      axes[2][i] = Narrow(m_Frames.mu[3][i + 1]);
    }
    __builtin_memcpy(expansion, from, sizeof(expansion));
    SetMonomials<N>(expansion, axes, halfDepth, m_Monomials);
    SetGrowth<N>(m_Monomials, Narrow(m_Frames.halfWidth), Narrow(m_Frames.halfHeight), halfDepth * largest, m_Growth);
    m_HasRays = false;
  }
  /** One cell on its own, in double precision. */
  void
  AddExact(std::size_t cell, int g)
  {
    CellGroup group;
    group.count = 1;
    group.parallel = m_Run.parallel;
    for (int i = 0; i < 4; ++i)
    {
      group.column[i][0] = m_Column[i][g];
      group.row[i][0] = m_Row[i][g];
      group.s[i][0] = m_S[i][g];
    }
    group.coefficients[0] = m_Run.density + cell * m_Run.densityStride;
    Complete(group);
    GroupFrame groupFrame;
    SetGroupFrame(group, groupFrame);
    Frame frame;
    if (!PlaceFrame(groupFrame, 0, m_Band, frame) || !SetPlanes(groupFrame, 0, frame))
    {
      return;
    }
    Group control[CoefficientCount(N)];
    LoadControl<N>(
      group.coefficients, groupFrame.halfDepth * m_Run.scale, groupFrame.halfDepth * m_Run.offset, control);
    RayPolynomials<N, Group> polynomials;
    SetDensities<N, Group>(control, groupFrame.mu, groupFrame.kappa, polynomials);
    AddInPrecision<double, N>(frame, RowPolynomial<double, N>(polynomials, 0), m_Band);
  }
  void
  SetRays()
  {
    if (!m_HasRays)
    {
      SetAlongRays<N, Batch>(m_Monomials, m_Shape.kappa, m_Polynomials);
      m_HasRays = true;
    }
  }
  /** The planes in double precision. */
  void
  AddSteep(int g)
  {
    Frame frame;
    if (!PlaceFrame(m_Frames, g, m_Band, frame) || !SetPlanes(m_Frames, g, frame))
    {
      return;
    }
    SetRays();
    frame.halfWidth = frame.halfHeight = 1; // the polynomials count pixels
    AddInPrecision<double, N>(frame, RowPolynomial<double, N>(m_Polynomials, g), m_Band);
  }
  void
  AddLarge(int g, const PixelBox & box)
  {
    SetRays();
    StripCell cell;
    cell.c0 = m_Frames.c0[g];
    cell.r0 = m_Frames.r0[g];
    cell.kappa = m_Shape.kappa[g];
    cell.fronts = m_Shape.fronts[g];
    int front = 0, back = 3;
    for (int i = 0; i < 4; ++i)
    {
      const int place = m_Frames.slope[i][g] < 0 ? front++ : back--;
      for (int k = 0; k < 3; ++k)
      {
        cell.depth[k][place] = m_Frames.depth[i][k][g];
      }
      cell.column[i] = m_Column[i][g];
      cell.row[i] = m_Row[i][g];
    }
    AddStrips<N>(cell, reinterpret_cast<const float *>(m_Polynomials.a) + g, box, m_Band);
  }

  const BlockRun & m_Run;
  const Band &     m_Band;
  Octet            m_Column[4], m_Row[4], m_S[4];
  Frames<Octet>    m_Frames;
  BlockShape       m_Shape;
  SpanList         m_Spans;

  Monomials<N, Batch>      m_Monomials; ///< times half the depth; X and Y count pixels at the centroid
  Batch                    m_Growth;    ///< how much rounding may
  bool                     m_HasRays{ false };
  RayPolynomials<N, Batch> m_Polynomials; ///< the same along rays, where a cell needs it
};

template <int N>
void
AddOfDegree(const BlockRun & run, const Band & band)
{
  BlockAdder<N> adder(run, band);
  for (std::size_t i = 0; i < run.count; ++i)
  {
    adder.Add(static_cast<std::size_t>(run.blocks[i]),
              static_cast<std::size_t>(run.blocks[i + 1 < run.count ? i + 1 : i]));
  }
}

inline void
AddBlocks(const BlockRun & run, const Band & band)
{
  using Function = void (*)(const BlockRun &, const Band &);
  constexpr Function byDegree[] = { AddOfDegree<0>, AddOfDegree<1>, AddOfDegree<2>, AddOfDegree<3>, AddOfDegree<4>,
                                    AddOfDegree<5>, AddOfDegree<6>, AddOfDegree<7>, AddOfDegree<8> };
  byDegree[run.degree](run, band);
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
