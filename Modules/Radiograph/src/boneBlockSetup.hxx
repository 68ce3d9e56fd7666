/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Blocks of eight cells as a view sees them, which all kernels of blocks begin with. It is compiled like
// boneProjectionKernel.hxx, which describes a cell's frame.

#ifndef boneBlockSetup_hxx
#define boneBlockSetup_hxx

#include "bonePowerKernel.hxx"
#include "boneSpanKernel.hxx"

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

/** A block of one degree: its geometry in double precision, its polynomials in single, and how its cells are to be
 * drawn. */
template <int N>
class BlockSetup
{
public:
  BlockSetup(const BlockRun & run, const Band & band)
    : m_Run(run)
    , m_Band(band)
  {}

protected:
  /** `next`: the block to come. */
  void
  SetBlock(std::size_t block, std::size_t next)
  {
    Fetch(next);
    SetGeometry(block);
    SetShape(m_Frames, m_Shape);
    SetPolynomials(block);
    CutRange(m_Frames.columns, m_Band.firstColumn, m_Band.columns, m_FirstColumn, m_EndColumn);
    CutRange(m_Frames.rows, m_Band.firstRow, m_Band.endRow, m_FirstRow, m_EndRow);
    // Too steep a plane, or a polynomial that grows too large, needs double precision; strips keep more of single
    // precision than spans, as they start anew in each row.
    constexpr double verySteep = 2e-3, steep = 5e-3;
    constexpr float  largestGrowth = 256;
    m_Exact = ~(m_Growth <= largestGrowth);
    m_Precise = FindSteep(m_Frames, verySteep);
    m_Fine = FindSteep(m_Frames, steep);
    const BatchIndex solid = __builtin_convertvector((m_Frames.halfWidth > 0) & (m_Frames.halfHeight > 0) &
                                                       (m_Frames.halfDepth > 0) & (Absolute(m_Frames.volume) > 0),
                                                     BatchIndex);
    // With no front or no back plane it is too flat to be seen.
    m_Seen =
      solid & (m_FirstColumn < m_EndColumn) & (m_FirstRow < m_EndRow) & (m_Shape.fronts > 0) & (m_Shape.fronts < 4);
    m_Cells = m_Run.cells + block * lanes;
    m_Spans.Clear();
  }
  PixelBox
  BoxOf(int g) const
  {
    return { m_FirstColumn[g], m_EndColumn[g], m_FirstRow[g], m_EndRow[g] };
  }
  /** Cells whose barycentric coordinates reach far over the cell's frame: how much rounding grows. */
  BatchIndex
  FindFarReaching() const
  {
    BatchIndex found{};
    for (int i = 0; i < 4; ++i)
    {
      const Octet reach = Absolute(m_Frames.mu[0][i]) + m_Frames.inPlane[i] + Absolute(m_Frames.mu[3][i]);
      found |= ~__builtin_convertvector(reach <= largestReach, BatchIndex);
    }
    return found;
  }

  /** A cell as a member of a group. */
  void
  AddToGroup(int g, CellGroup & group) const
  {
    const int member = group.count++;
    for (int i = 0; i < 4; ++i)
    {
      group.column[i][member] = m_Column[i][g];
      group.row[i][member] = m_Row[i][g];
      group.s[i][member] = m_S[i][g];
    }
    group.coefficients[member] = m_Run.density + static_cast<std::size_t>(m_Cells[g]) * m_Run.densityStride;
  }

  const BlockRun &     m_Run;
  const Band &         m_Band;
  const std::int32_t * m_Cells{ nullptr }; ///< eight; -1 after the last of all
  Octet                m_Column[4], m_Row[4], m_S[4];
  Frames<Octet>        m_Frames;
  BlockShape           m_Shape;
  SpanList             m_Spans;
  Monomials<N, Batch>  m_Monomials; ///< times half the depth; X and Y count pixels at the centroid
  Batch                m_Growth;    ///< how much rounding may
  BatchIndex           m_FirstColumn, m_EndColumn, m_FirstRow, m_EndRow; ///< within the band
  BatchIndex           m_Seen;                                           ///< whether a cell is
  BatchIndex           m_Exact;                                          ///< needs double precision throughout
  BatchIndex           m_Precise;                                        ///< needs it for its planes
  BatchIndex           m_Fine;                                           ///< needs strips

private:
  /** Always inlined: GCC takes it for a function without effects and leaves calls out. */
  inline __attribute__((always_inline)) void
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
  }
};
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone

#endif
