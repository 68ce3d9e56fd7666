/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Derivatives of the projection and its adjoint, compiled like boneProjectionKernel.hxx, which see for the cell's
// frame.
//
// The rays of a row (one eta) lie in a plane with coordinates X = (1 + kappa z) xi and z, where a density of degree N
// is a polynomial of that degree in two variables: for any density, the integral along a ray is a sum over the moments
//   I_ak = integral of X^a z^k dz,  a + k <= N,
// times coefficients that are polynomials in eta ("levels" below). The moments serve every density mode.
//
// A displacement w of the vertices moves the cell's points by an affine field. Across the ray that is
// u_X = w_X - kappa xi w_z and u_Y = w_Y - kappa eta w_z, both affine in z along a ray; along it, the cell is stretched
// by dw_z/dz. With
//   G_X(phi) = - integral of (d rho / dX) phi dz + rho (1 + kappa z) phi (dv/dxi of the face's plane), exit less entry,
// and G_Y alike, the cell's integral I changes by the sum of G(1), G(z) and I times the field's parts. At one eta these
// are polynomials in xi, which makes nine functions of the ray for all shape modes, again with coefficients in eta.
// Rigid motion needs I, G(1) and G(s - middle) alone, which are added up and combined pixel by pixel.
//
// The adjoint sums the same functions over the pixels of each row, then by levels over the rows.

#include "boneModeTables.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** The density of a cell and its rates along X and Y, in this order, in a group's table. */
template <int N>
struct DensityTable
{
  static constexpr int lower = N > 0 ? PlaneCount(N - 1) : 0;
  static constexpr int count = PlaneCount(N) + 2 * lower;
  static constexpr int rateX = PlaneCount(N);
  static constexpr int rateY = rateX + lower;

  Group levels[N + 1][count];

  void
  Set(const CellGroup & group, const GroupFrame & frame)
  {
    Group control[CoefficientCount(N)];
    LoadControl<N>(group.coefficients, frame.halfDepth * group.scale, frame.halfDepth * group.offset, control);
    Monomials<N> monomials;
    SetMonomials<N>(control, frame.mu, monomials);
    SetLevels<N>(monomials, frame.kappa, levels[0], count);
    if constexpr (N > 0)
    {
      Monomials<N - 1> x, y;
      for (int a = 0; a < N; ++a)
      {
        for (int b = 0; a + b < N; ++b)
        {
          for (int k = 0; a + b + k < N; ++k)
          {
            x.q[a][b][k] = (a + 1.0) * monomials.q[a + 1][b][k];
            y.q[a][b][k] = (b + 1.0) * monomials.q[a][b + 1][k];
          }
        }
      }
      SetLevels<N - 1>(x, frame.kappa, levels[0] + rateX, count);
      SetLevels<N - 1>(y, frame.kappa, levels[0] + rateY, count);
      for (int i = rateX; i < count; ++i)
      {
        levels[N][i] = Group{};
      }
    }
  }
};

/** What one cell is along the rays of a row. */
template <typename TReal>
struct RayStarts
{
  TReal depth[4], depthStep[4]; ///< of the planes, as in Frame
  TReal perXi[4], perEta[4];    ///< change of these depths
  TReal xi, xiStep;
  TReal kappa;
  int   fronts;
};

/** All that the modes need of eight rays and a cell; see the top. */
template <typename TReal, int N>
struct RayFunctions
{
  using Lanes = typename Vector<TReal>::Type;
  Lanes value;
  Lanes moment[PlaneCount(N)];
  Lanes gx, gxz, gy, gyz; ///< G_X(1), G_X(z), G_Y(1), G_Y(z)
  Lanes shape[shapeFunctions];
};

/** What a ray meets where it enters or leaves. */
template <typename TLanes>
struct RayEnd
{
  TLanes depth;
  TLanes perXi, perEta; ///< of the plane that is met
  TLanes magnification; ///< 1 + kappa z
  TLanes z;
};

template <typename TReal, typename TLanes>
inline void
FindEnds(const RayStarts<TReal> & rays, const TLanes & index, RayEnd<TLanes> & entry, RayEnd<TLanes> & exit)
{
  const auto meet = [&](int plane, RayEnd<TLanes> & end) {
    end.depth = rays.depth[plane] + rays.depthStep[plane] * index;
    end.perXi = TLanes{} + rays.perXi[plane];
    end.perEta = TLanes{} + rays.perEta[plane];
  };
  meet(0, entry);
  meet(3, exit);
  for (int i = 1; i < 3; ++i)
  {
    RayEnd<TLanes> other;
    meet(i, other);
    RayEnd<TLanes> & end = i < rays.fronts ? entry : exit;
    const auto       inner = i < rays.fronts ? other.depth < end.depth : other.depth > end.depth;
    end.depth = inner ? other.depth : end.depth;
    end.perXi = inner ? other.perXi : end.perXi;
    end.perEta = inner ? other.perEta : end.perEta;
  }
}

/** `density` is DensityTable's values for the row; rays at `index`, those below `end`. */
template <typename TReal, int N>
inline __attribute__((always_inline)) void
SetFunctions(const RayStarts<TReal> &             rays,
             const TReal *                        density,
             const typename Vector<TReal>::Type & index,
             TReal                                end,
             bool                                 withShape,
             RayFunctions<TReal, N> &             functions)
{
  using Lanes = typename Vector<TReal>::Type;
  using Basis = PlaneBasis<N>;
  constexpr int points = N / 2 + 1;
  const Lanes   none{};

  RayEnd<Lanes> entry, exit;
  FindEnds(rays, index, entry, exit);
  const auto hit = (entry.depth > exit.depth) & (index < end);
  entry.depth = hit ? entry.depth : none;
  exit.depth = hit ? exit.depth : none;
  const Lanes a = 1 + rays.kappa * entry.depth, b = 1 + rays.kappa * exit.depth;
  const Lanes inverse = 1 / (a * b);
  const Lanes length = (entry.depth - exit.depth) * inverse;
  entry.magnification = b * inverse;
  exit.magnification = a * inverse;
  entry.z = -entry.depth * entry.magnification;
  exit.z = -exit.depth * exit.magnification;

  const Lanes xi = rays.xi + rays.xiStep * index;
  const Lanes half = TReal(0.5) * length, middle = entry.z + half;
  for (int g = 0; g < points; ++g)
  {
    const Lanes z = middle + TReal(Gauss<points>::x[g]) * half;
    Lanes       products[Basis::count];
    Basis::Products(TReal(Gauss<points>::w[g]) * length, (1 + rays.kappa * z) * xi, z, products);
    Repeat<Basis::count>(
      [&](int q) { functions.moment[q] = g == 0 ? products[q] : functions.moment[q] + products[q]; });
  }
  Lanes value = none;
  Repeat<Basis::count>([&](int q) { value += density[q] * functions.moment[q]; });
  functions.value = value;
  if (!withShape)
  {
    functions.gx = functions.gxz = functions.gy = functions.gyz = none;
    Repeat<shapeFunctions>([&](int q) { functions.shape[q] = none; });
    return;
  }

  Lanes gx = none, gxz = none, gy = none, gyz = none;
  if constexpr (N > 0)
  {
    using Table = DensityTable<N>;
    for (int i = 0; i < N; ++i)
    {
      for (int k = 0; k < N - i; ++k)
      {
        const TReal x = density[Table::rateX + PlaneBasis<N - 1>::At(i, k)];
        const TReal y = density[Table::rateY + PlaneBasis<N - 1>::At(i, k)];
        gx -= x * functions.moment[Basis::At(i, k)];
        gxz -= x * functions.moment[Basis::At(i, k + 1)];
        gy -= y * functions.moment[Basis::At(i, k)];
        gyz -= y * functions.moment[Basis::At(i, k + 1)];
      }
    }
  }
  Lanes in, out;
  Basis::Value(density, entry.magnification * xi, entry.z, in);
  Basis::Value(density, exit.magnification * xi, exit.z, out);
  in = hit ? in * entry.magnification : none;
  out = hit ? out * exit.magnification : none;
  const Lanes inX = in * entry.perXi, inY = in * entry.perEta;
  const Lanes outX = out * exit.perXi, outY = out * exit.perEta;
  gx += outX - inX;
  gy += outY - inY;
  gxz += outX * exit.z - inX * entry.z;
  gyz += outY * exit.z - inY * entry.z;
  functions.gx = gx;
  functions.gxz = gxz;
  functions.gy = gy;
  functions.gyz = gyz;
  functions.shape[0] = gx;
  functions.shape[1] = xi * gx;
  functions.shape[2] = gxz;
  functions.shape[3] = xi * gxz;
  functions.shape[4] = xi * (functions.shape[1] + rays.kappa * functions.shape[3] - value);
  functions.shape[5] = gy;
  functions.shape[6] = gyz;
  functions.shape[7] = xi * (gy + rays.kappa * gyz);
  functions.shape[8] = value;
}

/** Calls consumer.StartRow(eta), consumer.Take(row, column, functions) and consumer.EndRow(eta) for all rays of a cell.
 */
template <typename TReal, int N, typename TConsumer>
inline void
ForEachRay(const Frame & frame, const DensityTable<N> & density, int member, bool withShape, TConsumer & consumer)
{
  using Lanes = typename Vector<TReal>::Type;
  TReal                  memory[RowTableSize(DensityTable<N>::count, N + 1)];
  RowTable<TReal, N + 1> table(memory, DensityTable<N>::count);
  table.Set(density.levels[0], member);
  RayStarts<TReal> rays;
  rays.kappa = static_cast<TReal>(frame.kappa);
  rays.fronts = frame.fronts;
  for (int i = 0; i < 4; ++i)
  {
    rays.depthStep[i] = static_cast<TReal>(frame.depth[i][1]);
    rays.perXi[i] = static_cast<TReal>(frame.depth[i][1] * frame.halfWidth);
    rays.perEta[i] = static_cast<TReal>(frame.depth[i][2] * frame.halfHeight);
  }
  const double xiPerColumn = 1.0 / frame.halfWidth, etaPerRow = 1.0 / frame.halfHeight;
  rays.xiStep = static_cast<TReal>(xiPerColumn);
  const Lanes index = { 0, 1, 2, 3, 4, 5, 6, 7 };
  for (int block = frame.firstRow; block < frame.endRow; block += lanes)
  {
    RowRuns runs;
    SetRowRuns(frame, block, runs);
    for (int j = 0; j < lanes && block + j < frame.endRow; ++j)
    {
      if (runs.count[j] <= 0)
      {
        continue;
      }
      const double dr = block + j - frame.r0, dc = runs.first[j] - frame.c0;
      for (int i = 0; i < 4; ++i)
      {
        const double(&depth)[3] = frame.depth[i];
        rays.depth[i] = static_cast<TReal>(depth[0] + depth[1] * dc + depth[2] * dr);
      }
      rays.xi = static_cast<TReal>(dc * xiPerColumn);
      const auto eta = static_cast<TReal>(dr * etaPerRow);
      table.At(eta);
      consumer.StartRow(eta);
      for (int i = 0; i < runs.count[j]; i += lanes)
      {
        RayFunctions<TReal, N> functions;
        SetFunctions<TReal, N>(
          rays, table.Values(), index + static_cast<TReal>(i), static_cast<TReal>(runs.count[j]), withShape, functions);
        consumer.Take(block + j, runs.first[j] + i, functions);
      }
      consumer.EndRow(eta);
    }
  }
}

/** Adds a cell's integrals and derivatives to the planes. */
template <typename TReal, int N>
class PlaneAdder
{
public:
  using Lanes = typename Vector<TReal>::Type;

  /** For a member of a group, whose tables are set. */
  PlaneAdder(const Derivatives &         derivatives,
             const Band &                band,
             const ModeTables<N> &       tables,
             const GroupFrame &          frame,
             const VertexMotion<Group> & motion,
             int                         member)
    : m_Derivatives(derivatives)
    , m_Band(band)
    , m_Density(Rows(tables, member), PlaneCount(N) * derivatives.densityModes)
    , m_Shape(Rows(tables, member) + RowTableSize(PlaneCount(N) * derivatives.densityModes, N + 1),
              shapeFunctions * derivatives.shapeModes)
    , m_PerX(static_cast<TReal>(motion.perX[member]))
    , m_PerY(static_cast<TReal>(motion.perY[member]))
    , m_Offset(static_cast<TReal>(frame.s0[member] - derivatives.middle))
    , m_PerZ(static_cast<TReal>(frame.halfDepth[member]))
  {
    if constexpr (std::is_same_v<TReal, double>)
    {
      m_Density.Set(tables.density, member);
      m_Shape.Set(tables.shape, member);
    }
  }

  void
  StartRow(TReal eta)
  {
    m_Density.At(eta);
    m_Shape.At(eta);
  }
  void
  EndRow(TReal)
  {}
  void
  Take(int row, int column, const RayFunctions<TReal, N> & functions)
  {
    const std::ptrdiff_t plane = m_Derivatives.plane;
    const int            shapeModes = m_Derivatives.shapeModes, densityModes = m_Derivatives.densityModes;
    float *              out = m_Band.data + (row - m_Band.firstRow) * m_Band.stride + column;
    Accumulate(out, functions.value);
    out += plane;
    if (m_Derivatives.pose)
    {
      const Lanes x = m_PerX * functions.gx, y = m_PerY * functions.gy;
      Accumulate(out, x);
      Accumulate(out + plane, y);
      Accumulate(out + 2 * plane, m_Offset * x + m_PerZ * (m_PerX * functions.gxz));
      Accumulate(out + 3 * plane, m_Offset * y + m_PerZ * (m_PerY * functions.gyz));
      out += posePlanes * plane;
    }
    AddModes<shapeFunctions>(m_Shape.Values(), functions.shape, shapeModes, plane, out);
    AddModes<PlaneCount(N)>(m_Density.Values(), functions.moment, densityModes, plane, out + shapeModes * plane);
  }

private:
  static TReal *
  Rows(const ModeTables<N> & tables, int member)
  {
    if constexpr (std::is_same_v<TReal, double>)
    {
      return tables.exactRows;
    }
    else
    {
      return tables.rows + member * tables.member;
    }
  }
  template <int TCount>
  static void
  AddModes(const TReal * factors, const Lanes (&terms)[TCount], int modes, std::ptrdiff_t plane, float * out)
  {
    for (int m = 0; m < modes; ++m, factors += TCount, out += plane)
    {
      // Two sums, as each waits for the term before.
      Lanes even{}, odd{};
      Repeat<TCount>([&](int q) { (q % 2 == 0 ? even : odd) += factors[q] * terms[q]; });
      Accumulate(out, even + odd);
    }
  }

  const Derivatives & m_Derivatives;
  const Band &        m_Band;

  RowTable<TReal, N + 1>       m_Density;
  RowTable<TReal, shapeLevels> m_Shape;

  TReal m_PerX, m_PerY;   ///< see VertexMotion
  TReal m_Offset, m_PerZ; ///< s - middle = offset + perZ z
};

/** Calls function(member, frame, exact) for the cells of the group that the band sees; `exact` where they need double
 * precision. */
template <int N, typename TFunction>
inline void
ForEachSeen(const CellGroup & group, const GroupFrame & groupFrame, const Band & band, const TFunction & function)
{
  constexpr double largestGrowth = 64;
  const Group      growth = Growth<N>(groupFrame);
  for (int g = 0; g < group.count; ++g)
  {
    Frame frame;
    if (PlaceFrame(groupFrame, g, band, frame) && SetPlanes(groupFrame, g, frame))
    {
      function(g, frame, frame.steep || !(growth[g] <= largestGrowth));
    }
  }
}

template <int N>
void
DeriveOfDegree(CellGroup & group, const Derivatives & derivatives, const Band & band)
{
  GroupFrame groupFrame;
  SetGroupFrame(group, groupFrame);
  DensityTable<N> density;
  density.Set(group, groupFrame);
  ModeTables<N> tables(derivatives);
  tables.SetShape(group, groupFrame, derivatives);
  tables.SetDensity(group, groupFrame, derivatives);
  ModeTables<N>::PrefetchNext(derivatives);
  bool                      exactSet = false;
  const VertexMotion<Group> motion = MotionOf(groupFrame, group.parallel);
  const bool                withShape = derivatives.pose || derivatives.shapeModes > 0;
  ForEachSeen<N>(group, groupFrame, band, [&](int member, const Frame & frame, bool exact) {
    if (exact)
    {
      if (!exactSet)
      {
        tables.SetExact(group, groupFrame, derivatives);
        exactSet = true;
      }
      PlaneAdder<double, N> adder(derivatives, band, tables, groupFrame, motion, member);
      ForEachRay<double, N>(frame, density, member, withShape, adder);
    }
    else
    {
      PlaneAdder<float, N> adder(derivatives, band, tables, groupFrame, motion, member);
      ForEachRay<float, N>(frame, density, member, withShape, adder);
    }
  });
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

/** The functions of a group's rays times the band's weights, summed by levels. */
template <int N>
struct LevelSums
{
  Group moment[N + 1][PlaneCount(N)]{};
  Group shape[shapeLevels][shapeFunctions]{};
};

/** Sums functions times weights over the rays of a cell. */
template <typename TReal, int N>
class RaySummer
{
public:
  using Lanes = typename Vector<TReal>::Type;

  RaySummer(const Band & band, bool withShape)
    : m_Band(band)
    , m_WithShape(withShape)
  {}

  void
  StartRow(TReal)
  {
    for (Lanes & sum : m_Row)
    {
      sum = Lanes{};
    }
  }
  void
  Take(int row, int column, const RayFunctions<TReal, N> & functions)
  {
    Lanes weights;
    LoadWeights(m_Band.data + (row - m_Band.firstRow) * m_Band.stride + column, weights);
    Repeat<moments>([&](int q) { m_Row[q] += weights * functions.moment[q]; });
    if (m_WithShape)
    {
      Repeat<shapeFunctions>([&](int q) { m_Row[moments + q] += weights * functions.shape[q]; });
    }
  }
  void
  EndRow(TReal eta)
  {
    TReal power = 1;
    for (int level = 0; level < levels; ++level, power *= eta)
    {
      Repeat<moments>([&](int q) { m_Levels[level][q] += power * m_Row[q]; });
      if (m_WithShape && level < shapeLevels)
      {
        Repeat<shapeFunctions>([&](int q) { m_Levels[level][moments + q] += power * m_Row[moments + q]; });
      }
    }
  }
  void
  Write(int member, LevelSums<N> & sums) const
  {
    for (int level = 0; level <= N; ++level)
    {
      for (int q = 0; q < moments; ++q)
      {
        sums.moment[level][q][member] = Sum(m_Levels[level][q]);
      }
    }
    for (int level = 0; level < shapeLevels; ++level)
    {
      for (int q = 0; q < shapeFunctions; ++q)
      {
        sums.shape[level][q][member] = Sum(m_Levels[level][moments + q]);
      }
    }
  }

private:
  static constexpr int moments = PlaneCount(N);
  static constexpr int levels = N + 1 > shapeLevels ? N + 1 : shapeLevels;

  const Band & m_Band;
  bool         m_WithShape;
  Lanes        m_Row[moments + shapeFunctions];
  Lanes        m_Levels[levels][moments + shapeFunctions] = {};
};

template <int N>
void
AdjoinOfDegree(CellGroup & group, const Adjoint & adjoint, const Band & band)
{
  GroupFrame groupFrame;
  SetGroupFrame(group, groupFrame);
  DensityTable<N> density;
  density.Set(group, groupFrame);
  LevelSums<N> sums;
  const bool   withShape = adjoint.positions[0] != nullptr;
  ForEachSeen<N>(group, groupFrame, band, [&](int member, const Frame & frame, bool exact) {
    if (exact)
    {
      RaySummer<double, N> summer(band, withShape);
      ForEachRay<double, N>(frame, density, member, withShape, summer);
      summer.Write(member, sums);
    }
    else
    {
      RaySummer<float, N> summer(band, withShape);
      ForEachRay<float, N>(frame, density, member, withShape, summer);
      summer.Write(member, sums);
    }
  });

  Monomials<N> monomials;
  SetLevelsAdjoint<N>(sums.moment[0], groupFrame.kappa, monomials);
  Group basis[CoefficientCount(N)] = {}, vertex[4][3];
  int   exponent[4] = { 0, 0, 0, 0 };
  BlossomAdjoint<N, N>::Run(basis, groupFrame.mu, 0, exponent, monomials);
  AffineField<Group> field;
  SetShapeLevelsAdjoint(sums.shape, groupFrame.kappa, field);
  SetFieldAdjoint(groupFrame, MotionOf(groupFrame, group.parallel), field, vertex);
  for (int g = 0; g < group.count; ++g)
  {
    for (int p = 0; p < CoefficientCount(N); ++p)
    {
      adjoint.basis[g][p] = groupFrame.halfDepth[g] * basis[p][g];
    }
    for (int i = 0; withShape && i < 12; ++i)
    {
      adjoint.positions[g][i] = vertex[i / 3][i % 3][g];
    }
  }
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

inline void
AdjoinCells(CellGroup & group, const Adjoint & adjoint, const Band & band)
{
  Complete(group);
  using Function = void (*)(CellGroup &, const Adjoint &, const Band &);
  constexpr Function byDegree[] = { AdjoinOfDegree<0>, AdjoinOfDegree<1>, AdjoinOfDegree<2>,
                                    AdjoinOfDegree<3>, AdjoinOfDegree<4>, AdjoinOfDegree<5>,
                                    AdjoinOfDegree<6>, AdjoinOfDegree<7>, AdjoinOfDegree<8> };
  byDegree[group.degree](group, adjoint, band);
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
