/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Conversion of the polynomials that a model keeps to monomials in a view. It is compiled like
// boneProjectionKernel.hxx.
//
// A polynomial is kept as its expansion about the tetrahedron's centroid in the edges from its first vertex,
//   f = sum over d of T_d(e, ..., e), e = (mu_1, mu_2, mu_3) - (1, 1, 1) / 4,
// T_d symmetric and linear in each of its d arguments: the numbers T_d(first edge, ..., second, ..., third, ...), layer
// d after layer d - 1, in a layer in the order of Bernstein coefficients. In a view the arguments are the axes of the
// cell's frame, of which the centroid is the origin: half the work of starting from Bernstein coefficients, where there
// would be four of them and none would be homogeneous.

#ifndef bonePowerKernel_hxx
#define bonePowerKernel_hxx

#include "boneTileKernel.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** (a + b + k)! / (a! b! k!) */
template <int N>
struct LayerMultinomials
{
  double of[N + 1][N + 1][N + 1]{};
  constexpr LayerMultinomials()
  {
    for (int a = 0; a <= N; ++a)
    {
      for (int b = 0; a + b <= N; ++b)
      {
        for (int k = 0; a + b + k <= N; ++k)
        {
          of[a][b][k] = factorial[a + b + k] / (factorial[a] * factorial[b] * factorial[k]);
        }
      }
    }
  }
};
template <int N>
constexpr LayerMultinomials<N> layerMultinomials;

/** The same by their places in an expansion. */
template <int N>
struct LayerFactors
{
  double of[CoefficientCount(N)]{};
  constexpr LayerFactors()
  {
    int p = 0;
    for (int jkl = 0; jkl <= N; ++jkl)
    {
      for (int kl = 0; kl <= jkl; ++kl)
      {
        for (int l = 0; l <= kl; ++l)
        {
          of[p++] = factorial[jkl] / (factorial[jkl - kl] * factorial[kl - l] * factorial[l]);
        }
      }
    }
  }
};
template <int N>
constexpr LayerFactors<N> layerFactors;

/** Which coefficients of degree D to subtract from which others, in turn, until each is the difference of as many steps
 * from the first vertex to the others as its index says. */
template <int D>
struct DifferenceSteps
{
  static constexpr int count = (D + 3) * (D + 2) * (D + 1) * D / 8;
  int                  to[count]{}, from[count]{};
  constexpr DifferenceSteps()
  {
    int at = 0;
    for (int axis = 0; axis < 3; ++axis)
    {
      for (int step = 1; step <= D; ++step)
      {
        for (int a = D; a >= step; --a)
        {
          for (int b = 0; a + b <= D; ++b)
          {
            for (int c = 0; a + b + c <= D; ++c, ++at)
            {
              to[at] = Position(axis, a, b, c);
              from[at] = Position(axis, a - 1, b, c);
            }
          }
        }
      }
    }
  }

private:
  /** Of the coefficient with exponent `a` of the axis, `b` and `c` of those that follow it in turn. */
  static constexpr int
  Position(int axis, int a, int b, int c)
  {
    const int exponents[3] = { axis == 0 ? a : (axis == 1 ? c : b),
                               axis == 1 ? a : (axis == 2 ? c : b),
                               axis == 2 ? a : (axis == 0 ? c : b) };
    const int l = exponents[2], kl = exponents[1] + l, jkl = exponents[0] + kl;
    return jkl * (jkl + 1) * (jkl + 2) / 6 + kl * (kl + 1) / 2 + l;
  }
};
template <int D>
constexpr DifferenceSteps<D> differenceSteps;

/** Layers D, D - 1, ... of an expansion, from coefficients of degree D that have N - D arguments at the centroid. */
template <int N, int D>
inline __attribute__((always_inline)) void
ExpandLayers(const Octet * net, float * expansion)
{
  if constexpr (D == 0)
  {
    StoreVector(expansion, Narrow(net[0]));
  }
  else
  {
    constexpr int below = CoefficientCount(D - 1);
    Octet         difference[CoefficientCount(D)];
    __builtin_memcpy(difference, net, sizeof(difference));
    constexpr int ofAxis = DifferenceSteps<D>::count / 3;
    Repeat<3>([&](int axis) __attribute__((always_inline)) {
      Repeat<ofAxis>([&](int i) __attribute__((always_inline)) {
        difference[differenceSteps<D>.to[axis * ofAxis + i]] -= difference[differenceSteps<D>.from[axis * ofAxis + i]];
      });
    });
    constexpr double choices = factorial[N] / (factorial[D] * factorial[N - D]);
    Repeat<CoefficientCount(D) - below>([&](int p) __attribute__((always_inline)) {
      StoreVector(expansion + (below + p) * lanes, Narrow(choices * difference[below + p]));
    });
    Octet lower[below];
    Repeat<below>([&](int p) __attribute__((always_inline)) {
      lower[p] = 0.25 * (net[p] + net[raise.second[p]] + net[raise.third[p]] + net[raise.third[p] + 1]);
    });
    ExpandLayers<N, D - 1>(lower, expansion);
  }
}

/** The transpose of ExpandLayers, up to layer D: from derivatives by the numbers of an expansion to those by
 * coefficients of degree D that have N - D arguments at the centroid. */
template <int N, int D = N>
inline __attribute__((always_inline)) void
CollectLayers(const Octet * expansion, Octet * net)
{
  if constexpr (D == 0)
  {
    net[0] = expansion[0];
  }
  else
  {
    constexpr int    count = CoefficientCount(D), below = CoefficientCount(D - 1), steps = DifferenceSteps<D>::count;
    constexpr double choices = factorial[N] / (factorial[D] * factorial[N - D]);
    Repeat<count>([&](int p) __attribute__((always_inline)) { net[p] = p < below ? Octet{} : choices * expansion[p]; });
    Repeat<3>([&](int axis) __attribute__((always_inline)) {
      Repeat<steps / 3>([&](int i) __attribute__((always_inline)) {
        const int step = steps - 1 - axis * (steps / 3) - i;
        net[differenceSteps<D>.from[step]] -= net[differenceSteps<D>.to[step]];
      });
    });
    Octet lower[below];
    CollectLayers<N, D - 1>(expansion, lower);
    Repeat<below>([&](int p) __attribute__((always_inline)) {
      const Octet share = 0.25 * lower[p];
      net[p] += share;
      net[raise.second[p]] += share;
      net[raise.third[p]] += share;
      net[raise.third[p] + 1] += share;
    });
  }
}

/** Kernels::expand for one degree. */
template <int N>
void
ExpandOfDegree(float * coefficients)
{
  constexpr int count = CoefficientCount(N);
  Octet         net[count];
  Repeat<count>([&](int p) __attribute__((always_inline)) {
    net[p] = __builtin_convertvector(LoadVector<Batch>(coefficients + p * lanes), Octet);
  });
  ExpandLayers<N, N>(net, coefficients);
}

inline void
Expand(int degree, float * coefficients)
{
  using Function = void (*)(float *);
  constexpr Function byDegree[] = { ExpandOfDegree<0>, ExpandOfDegree<1>, ExpandOfDegree<2>,
                                    ExpandOfDegree<3>, ExpandOfDegree<4>, ExpandOfDegree<5>,
                                    ExpandOfDegree<6>, ExpandOfDegree<7>, ExpandOfDegree<8> };
  byDegree[degree](coefficients);
}

/** Where (j, k+1, l) stands in a layer, for each (j, k, l) of the layer below; (j, k, l+1) is one further on and
 * (j+1, k, l) stays in place. */
struct Lift
{
  int of[CoefficientCount(7) - CoefficientCount(6)]{};
  constexpr Lift()
  {
    int p = 0;
    for (int kl = 0; kl <= 7; ++kl)
    {
      for (int l = 0; l <= kl; ++l, ++p)
      {
        of[p] = (kl + 1) * (kl + 2) / 2 + l;
      }
    }
  }
};
constexpr Lift lift;

/** From layer D of an expansion (`in`, in three arguments still free) to monomials: E1..E3 say how often each axis has
 * entered, W is the first still to use. */
template <int N, int D, int W, int E1, int E2, int E3, typename TLanes>
inline __attribute__((always_inline)) void
EnterAxes(const TLanes * in, const TLanes (&axes)[3][3], const TLanes & scale, Monomials<N, TLanes> & result)
{
  if constexpr (D == 0)
  {
    using Real = std::decay_t<decltype(in[0][0])>;
    result.q[E1][E2][E3] = static_cast<Real>(layerMultinomials<N>.of[E1][E2][E3]) * scale * in[0];
  }
  else
  {
    TLanes out[D * (D + 1) / 2];
    Repeat<D *(D + 1) / 2>([&](int p) __attribute__((always_inline)) {
      out[p] = axes[W][0] * in[p] + axes[W][1] * in[lift.of[p]] + axes[W][2] * in[lift.of[p] + 1];
    });
    EnterAxes<N, D - 1, W, E1 + (W == 0 ? 1 : 0), E2 + (W == 1 ? 1 : 0), E3 + (W == 2 ? 1 : 0)>(
      out, axes, scale, result);
    if constexpr (W < 2)
    {
      EnterAxes<N, D, W + 1, E1, E2, E3>(in, axes, scale, result);
    }
  }
}

/** The same with everything known at run time, for degrees where EnterAxes would grow too large. */
template <int N, int D, typename TLanes>
struct AxesEntry
{
  static void
  Run(const TLanes * in,
      const TLanes (&axes)[3][3],
      int next,
      int (&exponent)[3],
      const TLanes &         scale,
      Monomials<N, TLanes> & result)
  {
    if constexpr (D == 0)
    {
      using Real = std::decay_t<decltype(in[0][0])>;
      const auto [a, b, k] = exponent;
      result.q[a][b][k] = static_cast<Real>(layerMultinomials<N>.of[a][b][k]) * scale * in[0];
    }
    else
    {
      TLanes out[D * (D + 1) / 2];
      for (int w = next; w < 3; ++w)
      {
        for (int p = 0; p < D * (D + 1) / 2; ++p)
        {
          out[p] = axes[w][0] * in[p] + axes[w][1] * in[lift.of[p]] + axes[w][2] * in[lift.of[p] + 1];
        }
        ++exponent[w];
        AxesEntry<N, D - 1, TLanes>::Run(out, axes, w, exponent, scale, result);
        --exponent[w];
      }
    }
  }
};

/** The monomials in a frame, times `scale`; axes: the change of mu_1, mu_2, mu_3 per unit of X, Y and z. */
template <int N, int D = N, typename TLanes>
inline __attribute__((always_inline)) void
SetMonomials(const TLanes * expansion, const TLanes (&axes)[3][3], const TLanes & scale, Monomials<N, TLanes> & result)
{
  const TLanes * const layer = expansion + (D == 0 ? 0 : CoefficientCount(D - 1));
  if constexpr (N <= 3)
  {
    EnterAxes<N, D, 0, 0, 0, 0>(layer, axes, scale, result);
  }
  else
  {
    int exponent[3] = { 0, 0, 0 };
    AxesEntry<N, D, TLanes>::Run(layer, axes, 0, exponent, scale, result);
  }
  if constexpr (D > 0)
  {
    SetMonomials<N, D - 1>(expansion, axes, scale, result);
  }
}

/** How much rounding may grow: the sum of the magnitudes of q X^a Y^b z^k, with |X| <= halfWidth, |Y| <= halfHeight and
 * |z| <= 1, over the largest magnitude of a Bernstein coefficient. */
template <int N>
inline void
SetGrowth(const Monomials<N, Batch> & monomials,
          const Batch &               halfWidth,
          const Batch &               halfHeight,
          const Batch &               largest,
          Batch &                     growth)
{
  Batch all{}, width = Batch{} + 1.0f;
  RepeatDegrees<N + 1>([&](int a) __attribute__((always_inline)) {
    Batch power = width;
    RepeatDegrees<N + 1>([&](int b) __attribute__((always_inline)) {
      if (a + b <= N)
      {
        Batch sum{};
        RepeatDegrees<N + 1>([&](int k) __attribute__((always_inline)) {
          if (a + b + k <= N)
          {
            sum += Absolute(monomials.q[a][b][k]);
          }
        });
        all += power * sum;
        power *= halfHeight;
      }
    });
    width *= halfWidth;
  });
  growth = largest > 0 ? all / largest : largest;
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone

#endif
