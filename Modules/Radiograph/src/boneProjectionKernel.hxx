/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The kernel of ProjectMesh. It is compiled once for each instruction set, into the namespace that
// BONE_PROJECTION_NAMESPACE names, so it calls no inline function from elsewhere: a linker could share that function
// with code for lesser processors.
//
// In the cell's frame, c = c0 + wc xi, r = r0 + wr eta, s = s0 + h z with |xi|, |eta|, |z| <= 1 at the vertices, and
// kappa = h / s0 (parallel beam: 0):
//   position   affine in X = (1 + kappa z) xi, Y = (1 + kappa z) eta and z
//   depth      v = -z / (1 + kappa z), in which each face plane is an affine function of (xi, eta)
//   density    sum of q_abk X^a Y^b z^k = sum over b, k, a of eta^b z^k xi^a A[b][k][a]
// The integral from z_in to z_out is h (z_out - z_in) times the mean of the polynomial in z.
// Blocks have their centroid as origin and count pixels in X and Y (wc = wr = 1); groups have the middle of their box.

#include "boneProjectionFrame.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
template <int N, typename TLanes = Group>
struct Monomials
{
  TLanes q[N + 1][N + 1][N + 1]; ///< of X^a Y^b z^k
};

/** N! / (e0! e1! e2! e3!) by e1, e2, e3. */
template <int N>
struct Multinomials
{
  double of[N + 1][N + 1][N + 1]{};
  constexpr Multinomials()
  {
    for (int x = 0; x <= N; ++x)
    {
      for (int y = 0; x + y <= N; ++y)
      {
        for (int z = 0; x + y + z <= N; ++z)
        {
          of[x][y][z] = factorial[N] / (factorial[N - x - y - z] * factorial[x] * factorial[y] * factorial[z]);
        }
      }
    }
  }
};
template <int N>
constexpr Multinomials<N> multinomials;

/** From Bernstein coefficients (`in`, of degree D) to monomials: the coefficient of X^a Y^b z^k is a multinomial times
 * the blossom at the columns of `mu`, each as often as its exponent (E1..E3 of columns 1..3) says. W is the first
 * column still to use. */
template <int N, int D, int W, int E1, int E2, int E3, typename TLanes>
inline __attribute__((always_inline)) void
Contract(const TLanes * in, const TLanes (&mu)[4][4], Monomials<N, TLanes> & result)
{
  if constexpr (D == 0)
  {
    using Real = std::decay_t<decltype(in[0][0])>;
    result.q[E1][E2][E3] = static_cast<Real>(multinomials<N>.of[E1][E2][E3]) * in[0];
  }
  else
  {
    TLanes out[CoefficientCount(D - 1)];
    Repeat<CoefficientCount(D - 1)>([&](int p) __attribute__((always_inline)) {
      out[p] = mu[W][0] * in[p] + mu[W][1] * in[raise.second[p]] + mu[W][2] * in[raise.third[p]] +
               mu[W][3] * in[raise.third[p] + 1];
    });
    Contract<N, D - 1, W, E1 + (W == 1 ? 1 : 0), E2 + (W == 2 ? 1 : 0), E3 + (W == 3 ? 1 : 0)>(out, mu, result);
    if constexpr (W < 3)
    {
      Contract<N, D, W + 1, E1, E2, E3>(in, mu, result);
    }
  }
}

/** The same with everything known at run time, for degrees where Contract would grow too large. */
template <int N, int D, typename TLanes>
struct Blossom
{
  static void
  Run(const TLanes * in, const TLanes (&mu)[4][4], int next, int (&exponent)[4], Monomials<N, TLanes> & result)
  {
    TLanes out[CoefficientCount(D - 1)];
    for (int w = next; w < 4; ++w)
    {
      for (int p = 0; p < CoefficientCount(D - 1); ++p)
      {
        out[p] = mu[w][0] * in[p] + mu[w][1] * in[raise.second[p]] + mu[w][2] * in[raise.third[p]] +
                 mu[w][3] * in[raise.third[p] + 1];
      }
      ++exponent[w];
      Blossom<N, D - 1, TLanes>::Run(out, mu, w, exponent, result);
      --exponent[w];
    }
  }
};

template <int N, typename TLanes>
struct Blossom<N, 0, TLanes>
{
  static void
  Run(const TLanes * in, const TLanes (&)[4][4], int, int (&exponent)[4], Monomials<N, TLanes> & result)
  {
    using Real = std::decay_t<decltype(in[0][0])>;
    const double factor = multinomials<N>.of[exponent[1]][exponent[2]][exponent[3]];
    result.q[exponent[1]][exponent[2]][exponent[3]] = static_cast<Real>(factor) * in[0];
  }
};

template <int N, typename TLanes>
inline void
SetMonomials(const TLanes (&control)[CoefficientCount(N)], const TLanes (&mu)[4][4], Monomials<N, TLanes> & result)
{
  if constexpr (N <= 3)
  {
    Contract<N, N, 0, 0, 0, 0>(control, mu, result);
  }
  else
  {
    int exponent[4] = { 0, 0, 0, 0 };
    Blossom<N, N, TLanes>::Run(control, mu, 0, exponent, result);
  }
}

/** The polynomial in z of X^a Y^b. */
template <int N, typename TLanes>
inline __attribute__((always_inline)) void
SetInZ(const Monomials<N, TLanes> & monomials, int a, int b, TLanes (&inZ)[N + 1])
{
  RepeatDegrees<N + 1>([&](int k) __attribute__((always_inline)) {
    if (a + b + k <= N)
    {
      inZ[k] = monomials.q[a][b][k];
    }
  });
}

/** Multiplies a polynomial in z by (1 + kappa z)^times, dropping what would exceed its degree: there is nothing. */
template <int N, typename TLanes>
inline __attribute__((always_inline)) void
Magnify(TLanes kappa, int times, TLanes (&inZ)[N + 1])
{
  RepeatDegrees<N>([&](int time) __attribute__((always_inline)) {
    RepeatDegrees<N>([&](int k) __attribute__((always_inline)) {
      if (time < times)
      {
        inZ[N - k] += kappa * inZ[N - k - 1];
      }
    });
  });
}

/** The densities of some cells: A[b][k * (N + 1) + a]. */
template <int N, typename TLanes>
struct RayPolynomials
{
  TLanes a[N + 1][(N + 1) * (N + 1)];
};

/** The same, ready to be evaluated for all (k, a) of a row at once. */
template <typename TReal, int N>
class RowPolynomial
{
public:
  template <typename TLanes>
  RowPolynomial(const RayPolynomials<N, TLanes> & densities, int member)
  {
    for (int b = 0; b <= N; ++b)
    {
      for (int j = 0; j < blocks * lanes; ++j)
      {
        m_A[b][j / lanes][j % lanes] = j < size ? static_cast<TReal>(densities.a[b][j][member]) : TReal(0);
      }
    }
  }

  static constexpr int size = (N + 1) * (N + 1);
  static constexpr int blocks = (size + lanes - 1) / lanes;

  void
  At(TReal eta, TReal (&values)[blocks * lanes]) const
  {
    for (int block = 0; block < blocks; ++block)
    {
      Lanes value = m_A[N][block];
      for (int b = N - 1; b >= 0; --b)
      {
        value = value * eta + m_A[b][block];
      }
      __builtin_memcpy(values + block * lanes, &value, sizeof(value));
    }
  }

private:
  using Lanes = typename Vector<TReal>::Type;
  Lanes m_A[N + 1][blocks];
};

template <int TPoints>
struct Gauss;
template <>
struct Gauss<1>
{
  static constexpr double x[] = { 0.0 }, w[] = { 1.0 };
};
template <>
struct Gauss<2>
{
  static constexpr double x[] = { -0.57735026918962576, 0.57735026918962576 }, w[] = { 0.5, 0.5 };
};
template <>
struct Gauss<3>
{
  static constexpr double x[] = { -0.77459666924148338, 0.0, 0.77459666924148338 };
  static constexpr double w[] = { 5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0 };
};
template <>
struct Gauss<4>
{
  static constexpr double x[] = { -0.86113631159405258,
                                  -0.33998104358485626,
                                  0.33998104358485626,
                                  0.86113631159405258 };
  static constexpr double w[] = { 0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693 };
};
template <>
struct Gauss<5>
{
  static constexpr double x[] = { -0.90617984593866399,
                                  -0.53846931010568309,
                                  0.0,
                                  0.53846931010568309,
                                  0.90617984593866399 };
  static constexpr double w[] = { 0.11846344252809454,
                                  0.23931433524968324,
                                  0.28444444444444444,
                                  0.23931433524968324,
                                  0.11846344252809454 };
};

/** One row: pixels 0..count, with the planes' depths at pixel 0 and per pixel, and the polynomial at the row. */
template <typename TReal, int N, int TFronts>
inline void
AddRow(const TReal (&start)[4],
       const TReal (&step)[4],
       const TReal * poly,
       TReal         xiStart,
       TReal         xiStep,
       TReal         kappa,
       int           count,
       float *       out)
{
  using Lanes = typename Vector<TReal>::Type;
  constexpr int points = N / 2 + 1;
  Lanes         index = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const Lanes   zero = {};
  const Lanes   end = zero + static_cast<TReal>(count);
  for (int i = 0; i < count; i += lanes)
  {
    Lanes entry = start[0] + step[0] * index;
    for (int f = 1; f < TFronts; ++f)
    {
      const Lanes depth = start[f] + step[f] * index;
      entry = depth < entry ? depth : entry;
    }
    Lanes exit = start[TFronts] + step[TFronts] * index;
    for (int b = TFronts + 1; b < 4; ++b)
    {
      const Lanes depth = start[b] + step[b] * index;
      exit = depth > exit ? depth : exit;
    }
    const Lanes a = 1 + kappa * entry, b = 1 + kappa * exit;
    const Lanes inverse = 1 / (a * b);
    const Lanes length = (entry - exit) * inverse;
    Lanes       mean = zero + poly[0];
    if constexpr (N > 0)
    {
      const Lanes half = TReal(0.5) * length;
      const Lanes middle = half - entry * b * inverse;
      const Lanes xi = xiStart + xiStep * index;
      Lanes       inZ[N + 1];
      for (int k = 0; k <= N; ++k)
      {
        inZ[k] = zero + poly[k * (N + 1) + N];
        for (int m = N - 1; m >= 0; --m)
        {
          inZ[k] = inZ[k] * xi + poly[k * (N + 1) + m];
        }
      }
      mean = zero;
      for (int g = 0; g < points; ++g)
      {
        const Lanes z = middle + TReal(Gauss<points>::x[g]) * half;
        Lanes       value = inZ[N];
        for (int k = N - 1; k >= 0; --k)
        {
          value = value * z + inZ[k];
        }
        mean += TReal(Gauss<points>::w[g]) * value;
      }
    }
    const Lanes value = length * mean;
    Accumulate(out + i, ((entry > exit) & (index < end)) ? value : zero);
    index += static_cast<TReal>(lanes);
  }
}

template <typename TReal, int N, int TFronts>
void
AddRows(const Frame & frame, const RowPolynomial<TReal, N> & polynomial, const Band & band)
{
  using Polynomial = RowPolynomial<TReal, N>;
  using Planes __attribute__((vector_size(4 * sizeof(double)))) = double;
  using RealPlanes __attribute__((vector_size(4 * sizeof(TReal)))) = TReal;
  Planes constant, perColumn, perRow;
  TReal  step[4];
  for (int i = 0; i < 4; ++i)
  {
    constant[i] = frame.depth[i][0];
    perColumn[i] = frame.depth[i][1];
    perRow[i] = frame.depth[i][2];
    step[i] = static_cast<TReal>(frame.depth[i][1]);
  }
  const double xiPerColumn = 1.0 / frame.halfWidth, etaPerRow = 1.0 / frame.halfHeight;
  for (int block = frame.firstRow; block < frame.endRow; block += lanes)
  {
    RowRuns runs;
    SetRowRuns(frame, block, runs);
    const int rows = frame.endRow - block < lanes ? frame.endRow - block : lanes;
    for (int j = 0; j < rows; ++j)
    {
      if (runs.count[j] <= 0)
      {
        continue;
      }
      const int        r = block + j, first = runs.first[j];
      const double     dr = r - frame.r0, dc = first - frame.c0;
      const RealPlanes at = __builtin_convertvector(constant + perColumn * dc + perRow * dr, RealPlanes);
      TReal            start[4], poly[Polynomial::blocks * lanes];
      __builtin_memcpy(start, &at, sizeof(at));
      polynomial.At(static_cast<TReal>(dr * etaPerRow), poly);
      // Broadcast from memory as they are needed: to permute them out of registers takes longer.
      __asm__ volatile("" : "+m"(start), "+m"(poly));
      AddRow<TReal, N, TFronts>(start,
                                step,
                                poly,
                                static_cast<TReal>(dc * xiPerColumn),
                                static_cast<TReal>(xiPerColumn),
                                static_cast<TReal>(frame.kappa),
                                runs.count[j],
                                band.data + (r - band.firstRow) * band.stride + first - band.firstColumn);
    }
  }
}

/** Rows of four become columns. */
inline void
Transpose(const Group (&from)[groupSize], Group * to)
{
  const Group a = __builtin_shufflevector(from[0], from[1], 0, 4, 2, 6);
  const Group b = __builtin_shufflevector(from[0], from[1], 1, 5, 3, 7);
  const Group c = __builtin_shufflevector(from[2], from[3], 0, 4, 2, 6);
  const Group d = __builtin_shufflevector(from[2], from[3], 1, 5, 3, 7);
  to[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  to[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  to[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  to[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/** The same for each half of four rows. */
inline void
Transpose(const Batch (&from)[groupSize], Batch * to)
{
  const Batch a = __builtin_shufflevector(from[0], from[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const Batch b = __builtin_shufflevector(from[0], from[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const Batch c = __builtin_shufflevector(from[2], from[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const Batch d = __builtin_shufflevector(from[2], from[3], 2, 10, 3, 11, 6, 14, 7, 15);
  to[0] = __builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13);
  to[1] = __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15);
  to[2] = __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13);
  to[3] = __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
}

/** scale * coefficients + offset of the cells of a group. */
template <int N>
void
LoadControl(const double * const (&coefficients)[groupSize],
            Group scale,
            Group offset,
            Group (&control)[CoefficientCount(N)])
{
  constexpr int count = CoefficientCount(N);
  for (int p = 0; p + groupSize <= count; p += groupSize)
  {
    Group rows[groupSize];
    for (int g = 0; g < groupSize; ++g)
    {
      __builtin_memcpy(rows + g, coefficients[g] + p, sizeof(Group));
    }
    Transpose(rows, control + p);
  }
  for (int p = count - count % groupSize; p < count; ++p)
  {
    for (int g = 0; g < groupSize; ++g)
    {
      control[p][g] = coefficients[g][p];
    }
  }
  for (Group & value : control)
  {
    value = scale * value + offset;
  }
}

/** From monomials in X, Y, z, which are density times h, to polynomials along the rays of each cell's frame. */
template <int N, typename TLanes>
void
SetAlongRays(const Monomials<N, TLanes> & monomials, TLanes kappa, RayPolynomials<N, TLanes> & densities)
{
  RepeatDegrees<N + 1>([&](int b) __attribute__((always_inline)) {
    RepeatDegrees<N + 1>([&](int a) __attribute__((always_inline)) {
      TLanes inZ[N + 1] = {};
      if (a + b <= N)
      {
        SetInZ<N>(monomials, a, b, inZ);
        Magnify<N>(kappa, a + b, inZ);
      }
      RepeatDegrees<N + 1>([&](int k) __attribute__((always_inline)) { densities.a[b][k * (N + 1) + a] = inZ[k]; });
    });
  });
}

/** The same from Bernstein coefficients. */
template <int N, typename TLanes>
void
SetDensities(const TLanes (&control)[CoefficientCount(N)],
             const TLanes (&mu)[4][4],
             TLanes                      kappa,
             RayPolynomials<N, TLanes> & densities)
{
  Monomials<N, TLanes> monomials;
  SetMonomials<N, TLanes>(control, mu, monomials);
  SetAlongRays<N, TLanes>(monomials, kappa, densities);
}

template <typename TReal, int N>
void
AddInPrecision(const Frame & frame, const RowPolynomial<TReal, N> & polynomial, const Band & band)
{
  switch (frame.fronts)
  {
    case 1:
      AddRows<TReal, N, 1>(frame, polynomial, band);
      break;
    case 2:
      AddRows<TReal, N, 2>(frame, polynomial, band);
      break;
    default:
      AddRows<TReal, N, 3>(frame, polynomial, band);
  }
}
} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
