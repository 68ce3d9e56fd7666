/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The image of the tetrahedra. It is compiled like boneProjectionKernel.hxx, which describes a cell's frame. Eight
// cells are set up at once (boneBlockSetup.hxx). Small cells then take spans, large ones and those of high degree
// strips, ill-conditioned ones rows in double precision.

#include "boneBlockSetup.hxx"
#include "boneStripKernel.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** Draws blocks of one degree. */
template <int N>
class BlockAdder : private BlockSetup<N>
{
public:
  using BlockSetup<N>::BlockSetup;

  /** `next`: the block to come. */
  void
  Add(std::size_t block, std::size_t next)
  {
    this->SetBlock(block, next);
    m_HasRays = false;
    for (int g = 0; g < lanes && m_Cells[g] >= 0; ++g)
    {
      if (m_Seen[g] == 0)
      {
        continue;
      }
      const PixelBox box = this->BoxOf(g);
      if (m_Exact[g] != 0)
      {
        AddExact(g);
      }
      else if (m_Precise[g] != 0)
      {
        AddSteep(g);
      }
      else if (N <= maximumSpanDegree && m_Fine[g] == 0 && FitsSpans(box, imageSpanBox))
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
  /** One cell on its own, in double precision. */
  void
  AddExact(int g)
  {
    CellGroup group;
    group.count = 0;
    group.parallel = m_Run.parallel;
    this->AddToGroup(g, group);
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

  using BlockSetup<N>::m_Run;
  using BlockSetup<N>::m_Band;
  using BlockSetup<N>::m_Cells;
  using BlockSetup<N>::m_Column;
  using BlockSetup<N>::m_Row;
  using BlockSetup<N>::m_Frames;
  using BlockSetup<N>::m_Shape;
  using BlockSetup<N>::m_Spans;
  using BlockSetup<N>::m_Monomials;
  using BlockSetup<N>::m_Seen;
  using BlockSetup<N>::m_Exact;
  using BlockSetup<N>::m_Precise;
  using BlockSetup<N>::m_Fine;

  bool                     m_HasRays{ false };
  RayPolynomials<N, Batch> m_Polynomials; ///< the monomials' along rays, where a cell needs it
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
