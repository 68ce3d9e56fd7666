/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The part of boneDerivativeKernel.hxx, which see, that knows nothing of pixels: the linear maps from a cell's
// Bernstein coefficients and from displacements of its vertices to the coefficients of the rays' functions, and their
// transposes.

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** Products X^a z^k with a + k <= N: by a, then by k. */
template <int N>
struct PlaneBasis
{
  static constexpr int count = PlaneCount(N);
  static constexpr int
  At(int a, int k)
  {
    return a * (N + 1) - a * (a - 1) / 2 + k;
  }

  /** products times `first`. */
  template <typename TLanes>
  static void
  Products(const TLanes & first, const TLanes & x, const TLanes & z, TLanes (&products)[count])
  {
    products[0] = first;
    for (int a = 0; a <= N; ++a)
    {
      if (a > 0)
      {
        products[At(a, 0)] = products[At(a - 1, 0)] * x;
      }
      for (int k = 1; k <= N - a; ++k)
      {
        products[At(a, k)] = products[At(a, k - 1)] * z;
      }
    }
  }

  template <typename TReal, typename TLanes>
  static void
  Value(const TReal * coefficients, const TLanes & x, const TLanes & z, TLanes & value)
  {
    value = TLanes{};
    for (int a = N; a >= 0; --a)
    {
      TLanes inZ = TLanes{} + coefficients[At(a, N - a)];
      for (int k = N - a - 1; k >= 0; --k)
      {
        inZ = inZ * z + coefficients[At(a, k)];
      }
      value = value * x + inZ;
    }
  }
};

template <int N>
inline void
MagnifyAdjoint(Group kappa, int times, Group (&inZ)[N + 1])
{
  for (; times > 0; --times)
  {
    for (int k = 1; k <= N; ++k)
    {
      inZ[k - 1] += kappa * inZ[k];
    }
  }
}

/** The coefficients by moment, levels 0..N of the powers of eta, `stride` apart. */
template <int N, typename TLanes>
inline void
SetLevels(const Monomials<N, TLanes> & monomials, TLanes kappa, TLanes * levels, int stride)
{
  RepeatDegrees<N + 1>([&](int b) __attribute__((always_inline)) {
    RepeatDegrees<N + 1>([&](int a) __attribute__((always_inline)) {
      TLanes inZ[N + 1] = {};
      if (a + b <= N)
      {
        SetInZ<N>(monomials, a, b, inZ);
        Magnify<N>(kappa, b, inZ);
      }
      RepeatDegrees<N + 1>([&](int k) __attribute__((always_inline)) {
        if (a + k <= N)
        {
          levels[b * stride + PlaneBasis<N>::At(a, k)] = inZ[k];
        }
      });
    });
  });
}

/** The transpose. */
template <int N>
inline void
SetLevelsAdjoint(const Group * levels, Group kappa, Monomials<N> & monomials)
{
  for (int b = 0; b <= N; ++b)
  {
    for (int a = 0; a <= N - b; ++a)
    {
      Group inZ[N + 1] = {};
      for (int k = 0; k <= N - a; ++k)
      {
        inZ[k] = levels[b * PlaneBasis<N>::count + PlaneBasis<N>::At(a, k)];
      }
      MagnifyAdjoint<N>(kappa, b, inZ);
      for (int k = 0; k <= N - a - b; ++k)
      {
        monomials.q[a][b][k] = inZ[k];
      }
    }
  }
}

/** The transpose of Blossom: from sums by monomial to sums by Bernstein coefficient, added to `out`. */
template <int N, int D>
struct BlossomAdjoint
{
  static void
  Run(Group * out, const Group (&mu)[4][4], int next, int (&exponent)[4], const Monomials<N> & sums)
  {
    for (int w = next; w < 4; ++w)
    {
      Group in[CoefficientCount(D - 1)] = {};
      ++exponent[w];
      BlossomAdjoint<N, D - 1>::Run(in, mu, w, exponent, sums);
      --exponent[w];
      for (int p = 0; p < CoefficientCount(D - 1); ++p)
      {
        out[p] += mu[w][0] * in[p];
        out[raise.second[p]] += mu[w][1] * in[p];
        out[raise.third[p]] += mu[w][2] * in[p];
        out[raise.third[p] + 1] += mu[w][3] * in[p];
      }
    }
  }
};

template <int N>
struct BlossomAdjoint<N, 0>
{
  static void
  Run(Group * out, const Group (&)[4][4], int, int (&exponent)[4], const Monomials<N> & sums)
  {
    out[0] += multinomials<N>.of[exponent[1]][exponent[2]][exponent[3]] * sums.q[exponent[1]][exponent[2]][exponent[3]];
  }
};

/** How much rounding may grow: bound of the monomials' magnitudes for control values within [-1, 1]. */
template <int N>
inline Group
Growth(const GroupFrame & frame)
{
  Group largest{};
  for (int i = 0; i < 4; ++i)
  {
    const Group reach = Absolute(frame.mu[0][i]) + frame.inPlane[i] + Absolute(frame.mu[3][i]);
    largest = reach > largest ? reach : largest;
  }
  Group growth = Group{} + 1.0;
  for (int i = 0; i < N; ++i)
  {
    growth *= largest;
  }
  return growth;
}

/** From a vertex's displacement as (s, column s, row s) (parallel beam: (s, column, row)) to the frame's X, Y, z. */
template <typename TLanes>
struct VertexMotion
{
  TLanes perX, perY, perZ;
  TLanes c0, r0; ///< what a step of s takes of column s and row s
};

inline VertexMotion<Group>
MotionOf(const GroupFrame & frame, bool parallel)
{
  return { 1.0 / (parallel ? frame.halfWidth : frame.s0 * frame.halfWidth),
           1.0 / (parallel ? frame.halfHeight : frame.s0 * frame.halfHeight),
           1.0 / frame.halfDepth,
           parallel ? Group{} : frame.c0,
           parallel ? Group{} : frame.r0 };
}

/** A displacement in the frame, (X, Y, z), as an affine function of (1, X, Y, z). */
template <typename TLanes>
struct AffineField
{
  TLanes of[3][4];
};

template <typename TLanes>
inline void
SetField(const TLanes (&mu)[4][4],
         const VertexMotion<TLanes> & motion,
         const TLanes (&vertex)[4][3],
         AffineField<TLanes> & field)
{
  for (int j = 0; j < 4; ++j)
  {
    const TLanes moved[3] = { motion.perX * (vertex[j][1] - motion.c0 * vertex[j][0]),
                              motion.perY * (vertex[j][2] - motion.r0 * vertex[j][0]),
                              motion.perZ * vertex[j][0] };
    for (int axis = 0; axis < 3; ++axis)
    {
      for (int k = 0; k < 4; ++k)
      {
        const TLanes part = mu[k][j] * moved[axis];
        field.of[axis][k] = j == 0 ? part : field.of[axis][k] + part;
      }
    }
  }
}

inline void
SetFieldAdjoint(const GroupFrame &          frame,
                const VertexMotion<Group> & motion,
                const AffineField<Group> &  sums,
                Group (&vertex)[4][3])
{
  for (int j = 0; j < 4; ++j)
  {
    Group moved[3] = {};
    for (int axis = 0; axis < 3; ++axis)
    {
      for (int k = 0; k < 4; ++k)
      {
        moved[axis] += frame.mu[k][j] * sums.of[axis][k];
      }
    }
    vertex[j][1] = motion.perX * moved[0];
    vertex[j][2] = motion.perY * moved[1];
    vertex[j][0] = motion.perZ * moved[2] - motion.c0 * vertex[j][1] - motion.r0 * vertex[j][2];
  }
}

/** The coefficients of the shape functions, see RayFunctions: levels 0..2 of the powers of eta, `stride` apart. */
template <typename TLanes>
inline void
SetShapeLevels(const AffineField<TLanes> & field, TLanes kappa, TLanes * levels, int stride)
{
  const TLanes(&x)[4] = field.of[0];
  const TLanes(&y)[4] = field.of[1];
  const TLanes(&z)[4] = field.of[2];
  const TLanes none{};
  const TLanes all[shapeLevels][shapeFunctions] = {
    { x[0], x[1] - kappa * z[0], x[3], kappa * (x[1] - z[3]), -kappa * z[1], y[0], y[3], y[1], z[3] },
    { x[2],
      -kappa * z[2],
      kappa * x[2],
      -kappa * kappa * z[2],
      none,
      y[2] - kappa * z[0],
      kappa * (y[2] - z[3]),
      -kappa * z[1],
      kappa * z[2] },
    { none, none, none, none, none, -kappa * z[2], -kappa * kappa * z[2], none, none }
  };
  for (int level = 0; level < shapeLevels; ++level)
  {
    for (int i = 0; i < shapeFunctions; ++i)
    {
      levels[level * stride + i] = all[level][i];
    }
  }
}

inline void
SetShapeLevelsAdjoint(const Group (&s)[shapeLevels][shapeFunctions], Group kappa, AffineField<Group> & field)
{
  field.of[0][0] = s[0][0];
  field.of[0][1] = s[0][1] + kappa * s[0][3];
  field.of[0][2] = s[1][0] + kappa * s[1][2];
  field.of[0][3] = s[0][2];
  field.of[1][0] = s[0][5];
  field.of[1][1] = s[0][7];
  field.of[1][2] = s[1][5] + kappa * s[1][6];
  field.of[1][3] = s[0][6];
  field.of[2][0] = -kappa * (s[0][1] + s[1][5]);
  field.of[2][1] = -kappa * (s[0][4] + s[1][7]);
  field.of[2][2] = -kappa * (s[1][1] + kappa * s[1][3] + s[2][5] + kappa * s[2][6] - s[1][8]);
  field.of[2][3] = s[0][8] - kappa * (s[0][3] + s[1][6]);
}

} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
