/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The image of the tetrahedra, compiled like boneProjectionKernel.hxx, which see for the cell's frame. Eight cells are
// set up at once, their geometry in double precision, their polynomials in single. Small cells then take spans, large
// ones and those of high degree strips, ill-conditioned ones rows in double precision.

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
    SetPolynomials(block);
    BatchIndex firstColumn, endColumn, firstRow, endRow;
    CutRange(m_Frames.columns, m_Band.firstColumn, m_Band.columns, firstColumn, endColumn);
    CutRange(m_Frames.rows, m_Band.firstRow, m_Band.endRow, firstRow, endRow);
    // Too steep a plane, or a polynomial that grows too large, needs double precision; strips keep more of single
    // precision than spans, as they start anew in each row.
    constexpr double verySteep = 1e-3, steep = 5e-3;
    constexpr float  largestGrowth = 64;
    const BatchIndex exact = FindSteep(m_Frames, verySteep) | ~(m_Polynomials.growth <= largestGrowth);
    const BatchIndex fine = FindSteep(m_Frames, steep);
    const BatchIndex solid = __builtin_convertvector((m_Frames.halfWidth > 0) & (m_Frames.halfHeight > 0) &
                                                       (m_Frames.halfDepth > 0) & (Absolute(m_Frames.volume) > 0),
                                                     BatchIndex);
    SetShape(m_Frames, m_Shape);
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
      IntegrateSpans<N>(m_Shape, reinterpret_cast<const float *>(m_Polynomials.a), m_Spans);
      AddSpans(m_Spans, m_Band);
    }
  }

private:
  void
  Fetch(std::size_t block) const
  {
    constexpr std::size_t vertices = 12 * lanes, coefficients = CoefficientCount(N) * lanes, line = 64;
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
    for (int i = 0; i < 4; ++i)
    {
      Octet x[3];
      for (int k = 0; k < 3; ++k)
      {
        x[k] = LoadVector<Octet>(from + (3 * i + k) * lanes) - m_Run.origin[k];
      }
      const Octet s = m[0][0] * x[0] + m[0][1] * x[1] + m[0][2] * x[2];
      const Octet c = m[1][0] * x[0] + m[1][1] * x[1] + m[1][2] * x[2];
      const Octet r = m[2][0] * x[0] + m[2][1] * x[1] + m[2][2] * x[2];
      const Octet inverse = m_Run.parallel ? Octet{} + 1.0 : 1.0 / s;
      m_Column[i] = c * inverse;
      m_Row[i] = r * inverse;
      m_S[i] = s;
    }
    SetFrames(m_Column, m_Row, m_S, m_Run.parallel, m_Frames);
  }
  void
  SetPolynomials(std::size_t block)
  {
    constexpr int count = CoefficientCount(N);
    Batch         mu[4][4], control[count];
    for (int k = 0; k < 4; ++k)
    {
      for (int i = 0; i < 4; ++i)
      {
        mu[k][i] = Narrow(m_Frames.mu[k][i]);
      }
    }
    const Batch         depth = Narrow(m_Frames.halfDepth);
    const float * const from = m_Run.coefficients + block * count * lanes;
    for (int p = 0; p < count; ++p)
    {
      control[p] = depth * LoadVector<Batch>(from + p * lanes);
    }
    SetDensities<N, Batch>(control, mu, Narrow(m_Frames.kappa), m_Polynomials);
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
  AddLarge(int g, const PixelBox & box)
  {
    StripCell cell;
    cell.c0 = m_Frames.c0[g];
    cell.r0 = m_Frames.r0[g];
    cell.perWidth = m_Shape.perWidth[g];
    cell.perHeight = m_Shape.perHeight[g];
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

  RayPolynomials<N, Batch> m_Polynomials;
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
