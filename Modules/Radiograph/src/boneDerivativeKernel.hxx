/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Derivatives of the projection and its adjoint, compiled like boneProjectionKernel.hxx, which see.
//
// Along a ray the barycentric coordinates are mu_i = (slope_i v + p_i) / (1 + kappa v) with p_i affine in the pixel. A
// displacement of the vertices by w_j changes mu_i at a fixed point by -sum_j M_ij mu_j, M_ij = grad mu_i . w_j, and so
//   dI = sum_ij M_ij K_ij,  K_ij = - integral of (d rho / d mu_i) mu_j
//                                  + rho mu_j / (d mu_i / ds) at the exit if that is through face i - at the entry ...
// with d mu_i / dz = -slope_i (1 + kappa v) on face i. As sum_i M_ij = 0, K_0j is subtracted from the others.
// Integrals along the chord are Gauss-Lobatto's: its ends are needed anyway.

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
template <int TPoints>
struct Lobatto;
template <>
struct Lobatto<2>
{
  static constexpr double x[] = { -1.0, 1.0 }, w[] = { 0.5, 0.5 };
};
template <>
struct Lobatto<3>
{
  static constexpr double x[] = { -1.0, 0.0, 1.0 }, w[] = { 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0 };
};
template <>
struct Lobatto<4>
{
  static constexpr double x[] = { -1.0, -0.44721359549995794, 0.44721359549995794, 1.0 };
  static constexpr double w[] = { 1.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 1.0 / 12.0 };
};
template <>
struct Lobatto<5>
{
  static constexpr double x[] = { -1.0, -0.65465367070797714, 0.0, 0.65465367070797714, 1.0 };
  static constexpr double w[] = { 0.05, 49.0 / 180.0, 16.0 / 45.0, 49.0 / 180.0, 0.05 };
};
template <>
struct Lobatto<6>
{
  static constexpr double x[] = {
    -1.0, -0.76505532392946469, -0.28523151648064510, 0.28523151648064510, 0.76505532392946469, 1.0
  };
  static constexpr double w[] = { 1.0 / 30.0,          0.18923747814892349, 0.27742918851774318,
                                  0.27742918851774318, 0.18923747814892349, 1.0 / 30.0 };
};

/** Multinomials in the coefficients' order, and for each product of degree N of barycentric coordinates one of degree
 * N - 1 and the vertex whose coordinate makes it up. */
template <int N>
struct Exponents
{
  double multinomial[CoefficientCount(N)]{};
  int    part[CoefficientCount(N)]{};
  int    vertex[CoefficientCount(N)]{};
  constexpr Exponents()
  {
    int p = 0;
    for (int i = N; i >= 0; --i)
    {
      for (int j = N - i; j >= 0; --j)
      {
        for (int k = N - i - j; k >= 0; --k, ++p)
        {
          const int l = N - i - j - k;
          multinomial[p] = factorial[N] / (factorial[i] * factorial[j] * factorial[k] * factorial[l]);
        }
      }
    }
    for (int q = 0; N > 0 && q < CoefficientCount(N - 1); ++q)
    {
      const int raised[4] = { q, raise.second[q], raise.third[q], raise.third[q] + 1 };
      for (int v = 0; v < 4; ++v)
      {
        part[raised[v]] = q;
        vertex[raised[v]] = v;
      }
    }
  }
};

/** function(0), ..., function(TCount - 1), unrolled where it is short. */
template <int TCount, int TFirst = 0, typename TFunction>
inline __attribute__((always_inline)) void
Repeat(const TFunction & function)
{
  if constexpr (TCount > 20)
  {
    for (int i = 0; i < TCount; ++i)
    {
      function(i);
    }
  }
  else if constexpr (TFirst < TCount)
  {
    function(TFirst);
    Repeat<TCount, TFirst + 1>(function);
  }
}

/** mu0^i mu1^j mu2^k mu3^l in the coefficients' order; `below` are those of one degree less. */
template <int N, typename TLanes>
inline void
RaiseProducts(const TLanes (&mu)[4], const TLanes * below, TLanes (&products)[CoefficientCount(N)])
{
  static constexpr Exponents<N> exponents;
  Repeat<CoefficientCount(N)>([&](int p) { products[p] = below[exponents.part[p]] * mu[exponents.vertex[p]]; });
}

template <int N, typename TLanes>
inline void
Products(const TLanes (&mu)[4], TLanes (&products)[CoefficientCount(N)])
{
  if constexpr (N == 0)
  {
    products[0] = TLanes{} + 1;
  }
  else if constexpr (N == 1)
  {
    Repeat<4>([&](int i) { products[i] = mu[i]; });
  }
  else
  {
    TLanes below[CoefficientCount(N - 1)];
    Products<N - 1>(mu, below);
    RaiseProducts<N>(mu, below, products);
  }
}

/** A cell's density for derivatives, multinomials and the factor h within. */
template <typename TReal, int N>
struct DerivedDensity
{
  static constexpr int lower = N > 0 ? N - 1 : 0;

  TReal rate[4][CoefficientCount(lower)]; ///< d rho / d mu_0 / N, and d rho / d mu_i less d rho / d mu_0

  DerivedDensity(const double * coefficients, double scale, double offset)
  {
    static constexpr Exponents<lower> exponents;
    for (int p = 0; p < CoefficientCount(lower); ++p)
    {
      const int raised[4] = { p, raise.second[p], raise.third[p], raise.third[p] + 1 };
      for (int i = 0; i < 4; ++i)
      {
        const double factor = exponents.multinomial[p] * scale;
        const double first = factor * coefficients[p];
        rate[i][p] = static_cast<TReal>(i == 0 ? first + exponents.multinomial[p] * offset
                                               : (N > 0 ? N * (factor * coefficients[raised[i]] - first) : 0.0));
      }
    }
  }
};

/** What one cell is along the rays of a row; see the top. */
template <typename TReal>
struct RayStarts
{
  TReal depth[4], depthStep[4]; ///< fronts first, as in Frame
  TReal p[4], pStep[4];         ///< by vertex
  TReal slope[4];               ///< by vertex
  TReal perSlope[4];            ///< 1 / slope of the planes, as in Frame
  TReal kappa;
};

template <typename TReal, int N>
struct Batch
{
  using Lanes = typename Vector<TReal>::Type;
  Lanes value;                      ///< integral
  Lanes k[3][4];                    ///< K_ij of vertices i = 1..3
  Lanes basis[CoefficientCount(N)]; ///< integrals of the products
};

/** The pixels at `index` of a row, those below `end`. */
template <typename TReal, int N>
inline void
SetBatch(const RayStarts<TReal> & rays,
         const int (&face)[4],
         int                                  fronts,
         const DerivedDensity<TReal, N> &     density,
         const typename Vector<TReal>::Type & index,
         TReal                                end,
         bool                                 withShape,
         bool                                 withDensity,
         Batch<TReal, N> &                    batch)
{
  using Lanes = typename Vector<TReal>::Type;
  constexpr int nodes = (N + 4) / 2; // exact to degree 2 nodes - 3
  const Lanes   none{};

  Lanes depth[4];
  for (int i = 0; i < 4; ++i)
  {
    depth[i] = rays.depth[i] + rays.depthStep[i] * index;
  }
  Lanes entry = depth[0], exit = depth[3];
  for (int i = 1; i < 3; ++i)
  {
    if (i < fronts)
    {
      entry = depth[i] < entry ? depth[i] : entry;
    }
    else
    {
      exit = depth[i] > exit ? depth[i] : exit;
    }
  }
  const auto hit = (entry > exit) & (index < end);
  entry = hit ? entry : none;
  exit = hit ? exit : none;
  const Lanes perEntry = 1 / (1 + rays.kappa * entry), perExit = 1 / (1 + rays.kappa * exit);
  const Lanes length = (entry - exit) * (perEntry * perExit);
  Lanes       from[4], to[4];
  for (int i = 0; i < 4; ++i)
  {
    const Lanes p = rays.p[i] + rays.pStep[i] * index;
    from[i] = (p + rays.slope[i] * entry) * perEntry;
    to[i] = (p + rays.slope[i] * exit) * perExit;
  }
  Lanes atEntry = none, atExit = none;
  batch.value = none;
  // The first node sets what the others add to.
  Repeat<nodes>([&](int g) {
    constexpr int below = DerivedDensity<TReal, N>::lower;
    Lanes         mu[4];
    for (int i = 0; i < 4; ++i)
    {
      const TReal ofStart = TReal(0.5 - 0.5 * Lobatto<nodes>::x[g]), ofEnd = TReal(0.5 + 0.5 * Lobatto<nodes>::x[g]);
      mu[i] = g == 0 ? from[i] : (g == nodes - 1 ? to[i] : ofStart * from[i] + ofEnd * to[i]);
    }
    const Lanes weight = TReal(Lobatto<nodes>::w[g]) * length;
    Lanes       products[CoefficientCount(below)], rate[4];
    Products<below>(mu, products);
    if (withDensity)
    {
      Lanes ofDegree[CoefficientCount(N)];
      if constexpr (N > 0)
      {
        RaiseProducts<N>(mu, products, ofDegree);
      }
      else
      {
        ofDegree[0] = products[0];
      }
      Repeat<CoefficientCount(N)>(
        [&](int p) { batch.basis[p] = g == 0 ? weight * ofDegree[p] : batch.basis[p] + weight * ofDegree[p]; });
    }
    for (int i = 0; i < (N > 0 ? 4 : 1); ++i)
    {
      Lanes sums[2] = { none, none };
      Repeat<CoefficientCount(below)>([&](int p) { sums[p % 2] += density.rate[i][p] * products[p]; });
      rate[i] = sums[0] + sums[1];
    }
    Lanes value = rate[0];
    if constexpr (N > 0)
    {
      value += TReal(1.0 / N) * (mu[1] * rate[1] + mu[2] * rate[2] + mu[3] * rate[3]);
    }
    batch.value += weight * value;
    atEntry = g == 0 ? value : atEntry;
    atExit = value;
    for (int i = 0; withShape && i < 3; ++i)
    {
      Lanes weighted = none;
      if constexpr (N > 0)
      {
        weighted = weight * rate[i + 1];
      }
      for (int q = 0; q < 4; ++q)
      {
        batch.k[i][q] = g == 0 ? -weighted * mu[q] : batch.k[i][q] - weighted * mu[q];
      }
    }
  });
  if (!withShape)
  {
    return;
  }
  // Face terms: positive at the entry since its slope is negative.
  const Lanes in = hit ? atEntry * perEntry : none, out = hit ? atExit * perExit : none;
  auto        openEntry = hit, openExit = hit; // where several planes meet, one counts
  for (int plane = 0; plane < 4; ++plane)
  {
    const bool front = plane < fronts;
    if (!front && plane < 3 && face[plane] == face[3])
    {
      continue;
    }
    const auto here = front ? (depth[plane] == entry) & openEntry : (depth[plane] == exit) & openExit;
    openEntry &= front ? ~here : openEntry;
    openExit &= front ? openExit : ~here;
    const Lanes at = here ? (front ? in : -out) : none;
    const Lanes moved = at * rays.perSlope[plane];
    for (int j = 0; j < 4; ++j)
    {
      const Lanes term = moved * (front ? from[j] : to[j]);
      for (int i = 0; i < 3; ++i)
      {
        if (face[plane] == i + 1)
        {
          batch.k[i][j] += term;
        }
        else if (face[plane] == 0)
        {
          batch.k[i][j] -= term;
        }
      }
    }
  }
}

/** Sets consumer.Slot() and calls consumer.Done(row, column) for all batches of a cell. */
template <typename TReal, int N, typename TConsumer>
inline void
ForEachBatch(const GroupFrame & group,
             int                member,
             const Frame &      frame,
             const double *     coefficients,
             double             scale,
             double             offset,
             bool               withShape,
             bool               withDensity,
             TConsumer &        consumer)
{
  using Lanes = typename Vector<TReal>::Type;
  const double                   h = group.halfDepth[member];
  const DerivedDensity<TReal, N> density(coefficients, h * scale, h * offset);
  const double                   perWidth = 1.0 / frame.halfWidth, perHeight = 1.0 / frame.halfHeight;
  RayStarts<TReal>               rays;
  rays.kappa = static_cast<TReal>(frame.kappa);
  for (int i = 0; i < 4; ++i)
  {
    rays.depthStep[i] = static_cast<TReal>(frame.depth[i][1]);
    rays.perSlope[i] = static_cast<TReal>(1.0 / group.slope[frame.face[i]][member]);
    rays.slope[i] = static_cast<TReal>(group.slope[i][member]);
    rays.pStep[i] = static_cast<TReal>(group.mu[1][i][member] * perWidth);
  }
  const Lanes index = { 0, 1, 2, 3, 4, 5, 6, 7 };
  for (int block = frame.firstRow; block < frame.endRow; block += lanes)
  {
    RowRuns runs;
    SetRowRuns(frame, block, runs);
    for (int j = 0; j < lanes && block + j < frame.endRow; ++j)
    {
      const double dr = block + j - frame.r0, dc = runs.first[j] - frame.c0;
      for (int i = 0; i < 4; ++i)
      {
        const double(&depth)[3] = frame.depth[i];
        rays.depth[i] = static_cast<TReal>(depth[0] + depth[1] * dc + depth[2] * dr);
        rays.p[i] = static_cast<TReal>(group.mu[0][i][member] + group.mu[1][i][member] * perWidth * dc +
                                       group.mu[2][i][member] * perHeight * dr);
      }
      for (int i = 0; i < runs.count[j]; i += lanes)
      {
        SetBatch<TReal, N>(rays,
                           frame.face,
                           frame.fronts,
                           density,
                           index + static_cast<TReal>(i),
                           static_cast<TReal>(runs.count[j]),
                           withShape,
                           withDensity,
                           consumer.Slot());
        consumer.Done(block + j, runs.first[j] + i);
      }
    }
  }
}

/** Gathers batches of a cell and adds them to the planes, plane by plane. */
template <typename TReal, int N>
class PlaneAdder
{
public:
  using Lanes = typename Vector<TReal>::Type;

  PlaneAdder(const Derivatives & derivatives, const Band & band)
    : m_Derivatives(derivatives)
    , m_Band(band)
    , m_Shape(reinterpret_cast<TReal *>(derivatives.scratch))
    , m_Density(m_Shape + 12 * derivatives.shapeModes)
  {}

  /** Takes the modes of one cell of the group. */
  void
  SetModes(int member, double scale)
  {
    static constexpr Exponents<N> exponents;
    for (int i = 0; i < 12 * m_Derivatives.shapeModes; ++i)
    {
      m_Shape[i] = static_cast<TReal>(m_Derivatives.shape[member][i]);
    }
    for (int m = 0; m < m_Derivatives.densityModes; ++m)
    {
      const double * mode = m_Derivatives.density[m] + m_Derivatives.coefficient[member];
      for (int p = 0; p < CoefficientCount(N); ++p)
      {
        m_Density[m * CoefficientCount(N) + p] = static_cast<TReal>(scale * exponents.multinomial[p] * mode[p]);
      }
    }
  }

  Batch<TReal, N> &
  Slot()
  {
    return m_Batches[m_Count];
  }
  void
  Done(int row, int column)
  {
    m_Out[m_Count++] = m_Band.data + (row - m_Band.firstRow) * m_Band.stride + column;
    if (m_Count == capacity)
    {
      Flush();
    }
  }
  void
  Flush()
  {
    std::ptrdiff_t plane = 0;
    for (int b = 0; b < m_Count; ++b)
    {
      Accumulate(m_Out[b], m_Batches[b].value);
    }
    for (int m = 0; m < m_Derivatives.shapeModes; ++m)
    {
      plane += m_Derivatives.plane;
      AddPlane<12>(m_Shape + 12 * m, plane, [](const Batch<TReal, N> & batch) { return &batch.k[0][0]; });
    }
    for (int m = 0; m < m_Derivatives.densityModes; ++m)
    {
      plane += m_Derivatives.plane;
      AddPlane<CoefficientCount(N)>(
        m_Density + m * CoefficientCount(N), plane, [](const Batch<TReal, N> & batch) { return batch.basis; });
    }
    m_Count = 0;
  }

private:
  template <int TCount, typename TTerms>
  void
  AddPlane(const TReal * factors, std::ptrdiff_t plane, const TTerms & termsOf)
  {
    Lanes factor[TCount];
    Repeat<TCount>([&](int q) { factor[q] = Lanes{} + factors[q]; });
    for (int b = 0; b < m_Count; ++b)
    {
      const Lanes * terms = termsOf(m_Batches[b]);
      Lanes         sums[2] = {};
      Repeat<TCount>([&](int q) { sums[q % 2] += factor[q] * terms[q]; });
      Accumulate(m_Out[b] + plane, sums[0] + sums[1]);
    }
  }

  static constexpr int capacity = N <= 3 ? 16 : 4; ///< what the first-level cache holds
  const Derivatives &  m_Derivatives;
  const Band &         m_Band;
  TReal *              m_Shape;
  TReal *              m_Density;
  Batch<TReal, N>      m_Batches[capacity];
  float *              m_Out[capacity];
  int                  m_Count{ 0 };
};

template <typename TReal, int N>
void
DeriveMember(const CellGroup &   group,
             const GroupFrame &  groupFrame,
             int                 member,
             const Frame &       frame,
             const Derivatives & derivatives,
             const Band &        band)
{
  PlaneAdder<TReal, N> adder(derivatives, band);
  adder.SetModes(member, groupFrame.halfDepth[member] * group.scale);
  ForEachBatch<TReal, N>(groupFrame,
                         member,
                         frame,
                         group.coefficients[member],
                         group.scale,
                         group.offset,
                         derivatives.shapeModes > 0,
                         derivatives.densityModes > 0,
                         adder);
  adder.Flush();
}

inline void
LoadWeights(const float * from, Vector<float>::Type & weights)
{
  __builtin_memcpy(&weights, from, sizeof(weights));
}
inline void
LoadWeights(const float * from, Vector<double>::Type & weights)
{
  for (int i = 0; i < lanes; ++i)
  {
    weights[i] = from[i];
  }
}

template <typename TLanes>
inline double
Sum(const TLanes & values)
{
  double sum = 0;
  for (int i = 0; i < lanes; ++i)
  {
    sum += values[i];
  }
  return sum;
}

/** Sums batches times the band's weights. */
template <typename TReal, int N>
class BatchSummer
{
public:
  using Lanes = typename Vector<TReal>::Type;

  BatchSummer(const Band & band, bool withShape)
    : m_Band(band)
    , m_WithShape(withShape)
  {}

  Batch<TReal, N> &
  Slot()
  {
    return m_Batch;
  }
  void
  Done(int row, int column)
  {
    Lanes weights;
    LoadWeights(m_Band.data + (row - m_Band.firstRow) * m_Band.stride + column, weights);
    for (int p = 0; p < CoefficientCount(N); ++p)
    {
      m_Basis[p] += weights * m_Batch.basis[p];
    }
    for (int q = 0; m_WithShape && q < 12; ++q)
    {
      m_Positions[q] += weights * m_Batch.k[q / 4][q % 4];
    }
  }
  void
  Write(double scale, double * basis, double * positions) const
  {
    static constexpr Exponents<N> exponents;
    for (int p = 0; p < CoefficientCount(N); ++p)
    {
      basis[p] = scale * exponents.multinomial[p] * Sum(m_Basis[p]);
    }
    for (int q = 0; m_WithShape && q < 12; ++q)
    {
      positions[q] = Sum(m_Positions[q]);
    }
  }

private:
  const Band &    m_Band;
  bool            m_WithShape;
  Batch<TReal, N> m_Batch{};
  Lanes           m_Basis[CoefficientCount(N)] = {};
  Lanes           m_Positions[12] = {};
};

template <typename TReal, int N>
void
AdjoinMember(const CellGroup &  group,
             const GroupFrame & groupFrame,
             int                member,
             const Frame &      frame,
             const Adjoint &    adjoint,
             const Band &       band)
{
  const bool            withShape = adjoint.positions[member] != nullptr;
  BatchSummer<TReal, N> summer(band, withShape);
  ForEachBatch<TReal, N>(
    groupFrame, member, frame, group.coefficients[member], group.scale, group.offset, withShape, true, summer);
  summer.Write(groupFrame.halfDepth[member], adjoint.basis[member], adjoint.positions[member]);
}

/** Calls function(member, frame) for the cells of the group that the band sees. */
template <typename TFunction>
inline void
ForEachSeen(CellGroup & group, GroupFrame & groupFrame, const Band & band, const TFunction & function)
{
  Complete(group);
  SetGroupFrame(group, groupFrame);
  for (int g = 0; g < group.count; ++g)
  {
    Frame frame;
    if (PlaceFrame(groupFrame, g, band, frame) && SetPlanes(groupFrame, g, frame))
    {
      function(g, frame);
    }
  }
}

template <int N>
void
DeriveOfDegree(CellGroup & group, const Derivatives & derivatives, const Band & band)
{
  GroupFrame groupFrame;
  ForEachSeen(group, groupFrame, band, [&](int member, const Frame & frame) {
    frame.steep ? DeriveMember<double, N>(group, groupFrame, member, frame, derivatives, band)
                : DeriveMember<float, N>(group, groupFrame, member, frame, derivatives, band);
  });
}

template <int N>
void
AdjoinOfDegree(CellGroup & group, const Adjoint & adjoint, const Band & band)
{
  GroupFrame groupFrame;
  ForEachSeen(group, groupFrame, band, [&](int member, const Frame & frame) {
    frame.steep ? AdjoinMember<double, N>(group, groupFrame, member, frame, adjoint, band)
                : AdjoinMember<float, N>(group, groupFrame, member, frame, adjoint, band);
  });
}

inline void
DeriveCells(CellGroup & group, const Derivatives & derivatives, const Band & band)
{
  using Function = void (*)(CellGroup &, const Derivatives &, const Band &);
  constexpr Function byDegree[] = { DeriveOfDegree<0>, DeriveOfDegree<1>, DeriveOfDegree<2>,
                                    DeriveOfDegree<3>, DeriveOfDegree<4>, DeriveOfDegree<5>,
                                    DeriveOfDegree<6>, DeriveOfDegree<7>, DeriveOfDegree<8> };
  byDegree[group.degree](group, derivatives, band);
}

inline void
AdjoinCells(CellGroup & group, const Adjoint & adjoint, const Band & band)
{
  using Function = void (*)(CellGroup &, const Adjoint &, const Band &);
  constexpr Function byDegree[] = { AdjoinOfDegree<0>, AdjoinOfDegree<1>, AdjoinOfDegree<2>,
                                    AdjoinOfDegree<3>, AdjoinOfDegree<4>, AdjoinOfDegree<5>,
                                    AdjoinOfDegree<6>, AdjoinOfDegree<7>, AdjoinOfDegree<8> };
  byDegree[group.degree](group, adjoint, band);
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
