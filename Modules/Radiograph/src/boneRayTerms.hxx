/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The terms of which all derivatives of a cell along a ray are sums. It is compiled like boneProjectionKernel.hxx,
// which describes a cell's frame.
//
// A cell's integral is linear in its Bernstein coefficients: the terms of the basis are the integrals of the products
// of barycentric coordinates mu. Its derivative by displacements of the vertices is linear in these: twelve terms. With
//   G_X,j = - integral of (d rho / dX) mu_j dz + rho (1 + kappa z) mu_j (dv/dxi of the face's plane), exit less entry,
// and G_Y,j alike, a displacement of vertex j by w counts by G_X,j and G_Y,j across the ray, where it is
// (w_X - kappa xi w_z, w_Y - kappa eta w_z), and along it by the mean density times (mu_j at exit - mu_j at entry) w_z.
// Displacements are in the coordinates (s, column s, row s), in a parallel beam (s, column, row).
//
// Both kinds of terms serve all modes: a mode's part is the sum of the terms times its coefficients or displacements in
// the cell. The pixels of a cell are listed one after another, whatever their rows, so that no lane is left empty.

#ifndef boneRayTerms_hxx
#define boneRayTerms_hxx

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** Rays whose terms are computed at once. */
template <typename TReal>
struct TermVector
{
  static constexpr int size = sizeof(TReal) == sizeof(float) ? BONE_PROJECTION_TILE_ROWS * lanes : lanes;
  typedef TReal        Type __attribute__((vector_size(size * sizeof(TReal))));
};

/** Pixels that are listed before their terms are computed. */
constexpr int listSize = 64;

constexpr int vertexTerms = 12; ///< by vertex, then s, column s, row s

constexpr int
LowerCount(int degree)
{
  return degree > 0 ? CoefficientCount(degree - 1) : 0;
}

/** Multinomials in the order of the Bernstein coefficients. */
template <int N>
struct BasisFactors
{
  double of[CoefficientCount(N)]{};
  constexpr BasisFactors()
  {
    int p = 0;
    for (int jkl = 0; jkl <= N; ++jkl)
    {
      for (int kl = 0; kl <= jkl; ++kl)
      {
        for (int l = 0; l <= kl; ++l)
        {
          of[p++] = factorial[N] / (factorial[N - jkl] * factorial[jkl - kl] * factorial[kl - l] * factorial[l]);
        }
      }
    }
  }
};
template <int N>
constexpr BasisFactors<N> basisFactors;

/** function(0), ..., function(TCount - 1), unrolled for low degrees alone. */
template <int TDegree, int TCount, typename TFunction>
inline __attribute__((always_inline)) void
RepeatLow(const TFunction & function)
{
  if constexpr (TDegree <= 3)
  {
    Repeat<TCount>(function);
  }
  else
  {
    for (int i = 0; i < TCount; ++i)
    {
      function(i);
    }
  }
}

/** Calls set(p, value) for each product of degree D of barycentric coordinates, without multinomials: one of degree
 * D - 1 (`lower`) times one of the coordinates. */
template <int D, typename TLanes, typename TSet>
inline __attribute__((always_inline)) void
RaiseProducts(const TLanes * lower, const TLanes (&mu)[4], const TSet & set)
{
  constexpr int count = CoefficientCount(D - 1), last = count - LowerCount(D - 1), edge = D;
  RepeatLow<D, count>([&](int q) __attribute__((always_inline)) { set(q, mu[0] * lower[q]); });
  RepeatLow<D, last>([&](int i) __attribute__((always_inline)) {
    const int q = count - last + i;
    set(raise.second[q], mu[1] * lower[q]);
  });
  RepeatLow<D, edge>([&](int i) __attribute__((always_inline)) {
    const int q = count - edge + i;
    set(raise.third[q], mu[2] * lower[q]);
  });
  set(CoefficientCount(D) - 1, mu[3] * lower[count - 1]);
}

/** All products of degree D. */
template <int D, typename TLanes>
inline __attribute__((always_inline)) void
SetProducts(const TLanes & first, const TLanes (&mu)[4], TLanes * products)
{
  if constexpr (D == 0)
  {
    products[0] = first;
  }
  else
  {
    TLanes lower[CoefficientCount(D - 1)];
    SetProducts<D - 1>(first, mu, lower);
    RaiseProducts<D>(
      lower, mu, [&](int p, const TLanes & value) __attribute__((always_inline)) { products[p] = value; });
  }
}

/** The densities of a group and their rates along X and Y (by column s and row s) and z, as factors of the products of
 * barycentric coordinates. */
template <int N>
class GroupDensity
{
public:
  static constexpr int count = CoefficientCount(N), lower = LowerCount(N), size = count + 3 * lower;

  void
  Set(const CellGroup & group, const GroupFrame & frame, Group perX, Group perY)
  {
    Group control[count];
    LoadControl<N>(group.coefficients, frame.halfDepth * group.scale, frame.halfDepth * group.offset, control);
    if constexpr (N > 0)
    {
      const Group none{}, scale[3] = { perX, perY, none + 1.0 };
      Group       gradient[3][4];
      for (int axis = 0; axis < 3; ++axis)
      {
        for (int i = 0; i < 4; ++i)
        {
          gradient[axis][i] = double(N) * scale[axis] * frame.mu[axis + 1][i];
        }
      }
      for (int q = 0; q < lower; ++q)
      {
        const Group * const second = control + raise.second[q];
        const Group * const third = control + raise.third[q];
        for (int axis = 0; axis < 3; ++axis)
        {
          const Group(&of)[4] = gradient[axis];
          m_Exact[count + axis * lower + q] =
            basisFactors<(N > 0 ? N - 1 : 0)>.of[q] *
            (of[0] * control[q] + of[1] * *second + of[2] * third[0] + of[3] * third[1]);
        }
      }
    }
    for (int p = 0; p < count; ++p)
    {
      m_Exact[p] = basisFactors<N>.of[p] * control[p];
    }
    for (int p = 0; p < size; ++p)
    {
      m_Rounded[p] = __builtin_convertvector(m_Exact[p], Half);
    }
  }

  /** A member's numbers, groupSize apart: density, then the rates. */
  template <typename TReal>
  const TReal *
  Of(int member) const
  {
    if constexpr (std::is_same_v<TReal, double>)
    {
      return reinterpret_cast<const double *>(m_Exact) + member;
    }
    else
    {
      return reinterpret_cast<const float *>(m_Rounded) + member;
    }
  }

private:
  typedef float Half __attribute__((vector_size(groupSize * sizeof(float))));
  Group         m_Exact[size];
  Half          m_Rounded[size];
};

/** From steps of column s and row s (parallel beam: of columns and rows) to those of the frame's X and Y. */
struct FrameSteps
{
  Group perX, perY;
};
inline FrameSteps
StepsOf(const GroupFrame & frame, bool parallel)
{
  return { 1.0 / (parallel ? frame.halfWidth : frame.s0 * frame.halfWidth),
           1.0 / (parallel ? frame.halfHeight : frame.s0 * frame.halfHeight) };
}

/** What a ray meets where it enters or leaves. */
template <typename TLanes>
struct RayEnd
{
  TLanes depth;
  TLanes perXi, perEta; ///< of the plane that is met
};

/** The terms of one cell's rays. */
template <typename TReal, int N>
class RayTerms
{
public:
  using Lanes = typename TermVector<TReal>::Type;
  static constexpr int count = CoefficientCount(N), lower = LowerCount(N), points = N / 2 + 1;

  RayTerms(const GroupFrame &      group,
           const Frame &           frame,
           const FrameSteps &      steps,
           const GroupDensity<N> & density,
           int                     member,
           bool                    parallel)
    : m_Density(density.template Of<TReal>(member))
    , m_Kappa(static_cast<TReal>(frame.kappa))
    , m_PerX(static_cast<TReal>(steps.perX[member]))
    , m_PerY(static_cast<TReal>(steps.perY[member]))
    , m_KappaX(static_cast<TReal>(frame.kappa / steps.perX[member]))
    , m_KappaY(static_cast<TReal>(frame.kappa / steps.perY[member]))
    , m_PerZ(static_cast<TReal>(1.0 / group.halfDepth[member]))
    , m_Column{ parallel ? TReal(0) : static_cast<TReal>(frame.c0),
                parallel ? TReal(0) : static_cast<TReal>(frame.halfWidth) }
    , m_Row{ parallel ? TReal(0) : static_cast<TReal>(frame.r0),
             parallel ? TReal(0) : static_cast<TReal>(frame.halfHeight) }
    , m_Fronts(frame.fronts)
  {
    for (int i = 0; i < 4; ++i)
    {
      for (int k = 0; k < 3; ++k)
      {
        m_Affine[i][k] = static_cast<TReal>(group.mu[k][i][member]);
      }
      m_Slope[i] = static_cast<TReal>(group.slope[i][member]);
      m_Depth[i][0] = static_cast<TReal>(frame.depth[i][0]);
      m_Depth[i][1] = static_cast<TReal>(frame.depth[i][1] * frame.halfWidth);
      m_Depth[i][2] = static_cast<TReal>(frame.depth[i][2] * frame.halfHeight);
    }
  }

  /** Calls basis(p, integral of the product p) and, if asked for, vertex(term, value), which are 0 for a ray beside the
   * cell or not `wanted`. */
  template <typename TWanted, typename TBasis, typename TVertex>
  inline __attribute__((always_inline)) void
  Make(const Lanes &   xi,
       const Lanes &   eta,
       const TWanted & wanted,
       bool            withVertices,
       const TBasis &  basis,
       const TVertex & vertex) const
  {
    const Lanes   none{};
    RayEnd<Lanes> entry, exit;
    FindEnds(xi, eta, entry, exit);
    const auto hit = (entry.depth > exit.depth) & wanted;
    entry.depth = hit ? entry.depth : none;
    exit.depth = hit ? exit.depth : none;
    const Lanes a = 1 + m_Kappa * entry.depth, b = 1 + m_Kappa * exit.depth;
    const Lanes inverse = 1 / (a * b);
    const Lanes length = (entry.depth - exit.depth) * inverse;
    const Lanes in = b * inverse, out = a * inverse; // 1 + kappa z at the ends
    Lanes       middle[4], half[4], atEntry[4], atExit[4];
    for (int i = 0; i < 4; ++i)
    {
      const Lanes at = m_Affine[i][0] + m_Affine[i][1] * xi + m_Affine[i][2] * eta;
      atEntry[i] = (at + m_Slope[i] * entry.depth) * in;
      atExit[i] = (at + m_Slope[i] * exit.depth) * out;
      middle[i] = TReal(0.5) * (atExit[i] + atEntry[i]);
      half[i] = TReal(0.5) * (atExit[i] - atEntry[i]);
    }
    Lanes sums[count];
    Lanes acrossX[4] = {}, acrossY[4] = {}, rise = none, bend = none;
    RepeatLow<N, points>([&](int g) __attribute__((always_inline)) {
      Lanes mu[4];
      for (int i = 0; i < 4; ++i)
      {
        mu[i] = middle[i] + TReal(Gauss<points>::x[g]) * half[i];
      }
      const Lanes weight = TReal(Gauss<points>::w[g]) * length;
      const auto  add = [&](int p, const Lanes & value) __attribute__((always_inline))
      {
        sums[p] = g == 0 ? value : sums[p] + value;
      };
      if constexpr (N == 0)
      {
        add(0, weight);
      }
      else
      {
        Lanes products[lower];
        SetProducts<N - 1>(weight, mu, products);
        RaiseProducts<N>(products, mu, add);
        if (withVertices)
        {
          Lanes rate[3];
          SetRates(products, rate);
          for (int i = 0; i < 4; ++i)
          {
            acrossX[i] -= mu[i] * rate[0];
            acrossY[i] -= mu[i] * rate[1];
          }
          const Lanes along = rate[2] + m_KappaX * xi * rate[0] + m_KappaY * eta * rate[1];
          rise += along;
          bend += TReal(Gauss<points>::x[g]) * along;
        }
      }
    });
    RepeatLow<N, count>([&](int p) __attribute__((always_inline)) { basis(p, sums[p]); });
    if (!withVertices)
    {
      return;
    }
    // Several sums: one addition after another would be waited for.
    constexpr int parts = count < 4 ? count : 4;
    Lanes         part[parts] = {};
    RepeatLow<N, count>([&](int p)
                          __attribute__((always_inline)) { part[p % parts] += m_Density[p * groupSize] * sums[p]; });
    Lanes value = part[0];
    for (int i = 1; i < parts; ++i)
    {
      value += part[i];
    }
    const Lanes mean = value / (hit ? length : none + 1);
    Lanes       inX, inY, outX, outY;
    {
      Lanes first, last;
      SetEndValues(mean, rise, bend, atEntry, atExit, first, last);
      first = hit ? first * in : none;
      last = hit ? last * out : none;
      inX = m_PerX * first * entry.perXi;
      inY = m_PerY * first * entry.perEta;
      outX = m_PerX * last * exit.perXi;
      outY = m_PerY * last * exit.perEta;
    }
    const Lanes column = m_Column[0] + m_Column[1] * xi, row = m_Row[0] + m_Row[1] * eta;
    const Lanes stretch = 2 * m_PerZ * mean;
    for (int i = 0; i < 4; ++i)
    {
      const Lanes x = acrossX[i] + outX * atExit[i] - inX * atEntry[i];
      const Lanes y = acrossY[i] + outY * atExit[i] - inY * atEntry[i];
      vertex(3 * i, stretch * half[i] - column * x - row * y);
      vertex(3 * i + 1, x);
      vertex(3 * i + 2, y);
    }
  }

private:
  inline __attribute__((always_inline)) void
  FindEnds(const Lanes & xi, const Lanes & eta, RayEnd<Lanes> & entry, RayEnd<Lanes> & exit) const
  {
    const auto meet = [&](int plane, RayEnd<Lanes> & end) __attribute__((always_inline))
    {
      end.depth = m_Depth[plane][0] + m_Depth[plane][1] * xi + m_Depth[plane][2] * eta;
      end.perXi = Lanes{} + m_Depth[plane][1];
      end.perEta = Lanes{} + m_Depth[plane][2];
    };
    meet(0, entry);
    meet(3, exit);
    for (int i = 1; i < 3; ++i)
    {
      RayEnd<Lanes> other;
      meet(i, other);
      RayEnd<Lanes> & end = i < m_Fronts ? entry : exit;
      const auto      inner = i < m_Fronts ? other.depth < end.depth : other.depth > end.depth;
      end.depth = inner ? other.depth : end.depth;
      end.perXi = inner ? other.perXi : end.perXi;
      end.perEta = inner ? other.perEta : end.perEta;
    }
  }

  inline __attribute__((always_inline)) void
  SetRates(const Lanes (&products)[lower > 0 ? lower : 1], Lanes (&rate)[3]) const
  {
    const TReal * from = m_Density + count * groupSize;
    rate[0] = rate[1] = rate[2] = Lanes{};
    RepeatLow<N, lower>([&](int q) __attribute__((always_inline)) {
      for (int axis = 0; axis < 3; ++axis)
      {
        rate[axis] += from[(axis * lower + q) * groupSize] * products[q];
      }
    });
  }

  /** The density where the rays enter and leave. Up to degree 3 it follows from its mean and two sums of its rate along
   * the ray, times the length, at the Gauss points: that of the rates, and that of rates times positions. */
  inline __attribute__((always_inline)) void
  SetEndValues(const Lanes & mean,
               const Lanes & rise,
               const Lanes & bend,
               const Lanes (&atEntry)[4],
               const Lanes (&atExit)[4],
               Lanes & first,
               Lanes & last) const
  {
    if constexpr (N <= 3)
    {
      // Mean of the ends less mean = length / 12 times the difference of the rates there: sqrt(3) / 12 times that of
      // the rates at the Gauss points, which are 1 / sqrt(3) from the middle and have a weight of 1 / 2.
      const Lanes ends = mean + TReal(0.5) * bend;
      first = ends - TReal(0.5) * rise;
      last = ends + TReal(0.5) * rise;
    }
    else
    {
      SetValue(atEntry, first);
      SetValue(atExit, last);
    }
  }
  void
  SetValue(const Lanes (&mu)[4], Lanes & value) const
  {
    Lanes products[count];
    value = Lanes{};
    SetProducts<N>(Lanes{} + 1, mu, products);
    for (int p = 0; p < count; ++p)
    {
      value += m_Density[p * groupSize] * products[p];
    }
  }

  const TReal * m_Density;
  TReal         m_Affine[4][3], m_Slope[4]; ///< see GroupFrame
  TReal         m_Depth[4][3];              ///< planes as in Frame: constant, per xi, per eta
  TReal         m_Kappa;
  TReal         m_PerX, m_PerY, m_KappaX, m_KappaY, m_PerZ;
  TReal         m_Column[2], m_Row[2]; ///< at the centre and by the frame's coordinate; parallel beam: 0
  int           m_Fronts;
};

/** Pixels of a cell, one after another. */
template <typename TReal>
struct PixelList
{
  TReal        xi[listSize + lanes]{}, eta[listSize + lanes]{};
  std::int32_t at[listSize + lanes]; ///< in the band
  int          count{ 0 };
};

/** Lists the pixels that a cell may cover; calls flush(list) when the list is full, and at the end. */
template <typename TReal, typename TFlush>
inline void
ForEachPixelList(const Frame & frame, const Band & band, PixelList<TReal> & list, const TFlush & flush)
{
  using Pixels = typename Vector<TReal>::Type;
  typedef std::int32_t Places __attribute__((vector_size(lanes * sizeof(std::int32_t))));
  const Pixels         index = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const Places         place = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const double         xiPerColumn = 1.0 / frame.halfWidth, etaPerRow = 1.0 / frame.halfHeight;
  const auto           xiStep = static_cast<TReal>(xiPerColumn);
  list.count = 0;
  for (int block = frame.firstRow; block < frame.endRow; block += lanes)
  {
    RowRuns runs;
    SetRowRuns(frame, block, runs);
    for (int j = 0; j < lanes && block + j < frame.endRow; ++j)
    {
      const int    start = (block + j - band.firstRow) * static_cast<int>(band.stride) - band.firstColumn;
      const Pixels eta = Pixels{} + static_cast<TReal>((block + j - frame.r0) * etaPerRow);
      int          column = runs.first[j];
      for (int left = runs.count[j]; left > 0;)
      {
        if (list.count == listSize)
        {
          flush(list);
          list.count = 0;
        }
        const int room = listSize - list.count, most = left < lanes ? left : lanes, taken = most < room ? most : room;
        const Pixels xi = static_cast<TReal>((column - frame.c0) * xiPerColumn) + xiStep * index;
        __builtin_memcpy(list.xi + list.count, &xi, sizeof(xi));
        __builtin_memcpy(list.eta + list.count, &eta, sizeof(eta));
        const Places at = start + column + place;
        __builtin_memcpy(list.at + list.count, &at, sizeof(at));
        list.count += taken;
        column += taken;
        left -= taken;
      }
    }
  }
  if (list.count > 0)
  {
    flush(list);
  }
}

/** Calls function(member, frame, exact) for the cells of the group that the band sees; `exact` where they need double
 * precision. */
template <typename TFunction>
inline void
ForEachSeen(const CellGroup & group, const GroupFrame & groupFrame, const Band & band, const TFunction & function)
{
  for (int g = 0; g < group.count; ++g)
  {
    double reach = 0;
    for (int i = 0; i < 4; ++i)
    {
      const double at = Absolute(groupFrame.mu[0][i][g]) + groupFrame.inPlane[i][g] + Absolute(groupFrame.mu[3][i][g]);
      reach = at > reach ? at : reach;
    }
    Frame frame;
    if (PlaceFrame(groupFrame, g, band, frame) && SetPlanes(groupFrame, g, frame))
    {
      function(g, frame, frame.steep || !(reach <= largestReach));
    }
  }
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone

#endif
