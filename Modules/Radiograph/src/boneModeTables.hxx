/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The part of boneDerivativeKernel.hxx, which see, that sets up the modes of some cells: the coefficients of the rays'
// functions as polynomials in the row.

#include "boneDerivativeMaps.hxx"

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** Functions of eta with coefficients by level, evaluated all at once for a row. */
template <typename TReal, int TLevels>
class RowTable
{
public:
  typedef TReal Wide __attribute__((vector_size(tableLanes * sizeof(TReal))));

  /** In `memory`, of RowTableSize(count, TLevels) numbers. */
  RowTable(TReal * memory, int count)
    : m_Stride((count + tableLanes - 1) / tableLanes * tableLanes)
    , m_Count(count)
    , m_Table(memory)
  {}

  /** Takes one member of a group's table, [level][count]. */
  template <typename TLanes>
  void
  Set(const TLanes * table, int member)
  {
    for (int level = 0; level < TLevels; ++level, table += m_Count)
    {
      TReal * to = m_Table + level * m_Stride;
      for (int i = 0; i < m_Count; ++i)
      {
        to[i] = static_cast<TReal>(table[i][member]);
      }
      Pad(to);
    }
  }
  void
  At(TReal eta)
  {
    for (int i = 0; i < m_Stride; i += tableLanes)
    {
      Wide value, next;
      __builtin_memcpy(&value, m_Table + (TLevels - 1) * m_Stride + i, sizeof(value));
#pragma GCC unroll 9
      for (int level = TLevels - 2; level >= 0; --level)
      {
        __builtin_memcpy(&next, m_Table + level * m_Stride + i, sizeof(next));
        value = value * eta + next;
      }
      __builtin_memcpy(m_Table + TLevels * m_Stride + i, &value, sizeof(value));
    }
  }
  const TReal *
  Values() const
  {
    return m_Table + TLevels * m_Stride;
  }

private:
  void
  Pad(TReal * to) const
  {
    for (int i = m_Count; i < m_Stride; ++i)
    {
      to[i] = TReal(0);
    }
  }

  int     m_Stride;
  int     m_Count;
  TReal * m_Table; ///< the levels, then the values
};

/** Tables of pairs of modes, [level][pair][each], each pair's first mode's four members before the second's, to each
 * member's row table, `member` numbers apart. */
template <int TEach, int TLevels>
inline void
Distribute(const Batch * pairs, int modes, float * rows, std::ptrdiff_t member)
{
  const int stride = (TEach * modes + tableLanes - 1) / tableLanes * tableLanes;
  for (int level = 0; level < TLevels; ++level, rows += stride)
  {
    for (int mode = 0; mode < modes; mode += 2, pairs += TEach)
    {
      const int halves = mode + 1 < modes ? 2 : 1;
      float *   to = rows + mode * TEach;
      int       q = 0;
      for (; q + lanes <= TEach; q += lanes)
      {
        Batch low[groupSize], high[groupSize], first[groupSize], second[groupSize];
        for (int k = 0; k < groupSize; ++k)
        {
          first[k] = pairs[q + k];
          second[k] = pairs[q + groupSize + k];
        }
        Transpose(first, low);
        Transpose(second, high);
        for (int g = 0; g < groupSize; ++g)
        {
          const Batch one = __builtin_shufflevector(low[g], high[g], 0, 1, 2, 3, 8, 9, 10, 11);
          const Batch two = __builtin_shufflevector(low[g], high[g], 4, 5, 6, 7, 12, 13, 14, 15);
          __builtin_memcpy(to + g * member + q, &one, sizeof(one));
          if (halves == 2)
          {
            __builtin_memcpy(to + g * member + TEach + q, &two, sizeof(two));
          }
        }
      }
      for (; q < TEach; ++q)
      {
        for (int i = 0; i < halves * groupSize; ++i)
        {
          to[i % groupSize * member + i / groupSize * TEach + q] = pairs[q][i];
        }
      }
    }
  }
}

/** The modes' tables of a group of cells, in the task's scratch memory: in single precision, two modes at a time, and
 * in double for members that need it. */
template <int N>
struct ModeTables
{
  static constexpr int each = PlaneCount(N), levels = N + 1;

  float *        rows;   ///< of each member: row tables of density and shape
  std::ptrdiff_t member; ///< from one member's to the next
  Batch *        pairs;  ///< see Distribute
  double *       exactRows;
  Group *        density; ///< [level][mode][moment]
  Group *        shape;   ///< [level][mode][function]

  ModeTables(const Derivatives & derivatives)
    : rows(static_cast<float *>(derivatives.scratch))
    , member(RowTableSize(each * derivatives.densityModes, levels) +
             RowTableSize(shapeFunctions * derivatives.shapeModes, shapeLevels))
    , pairs(reinterpret_cast<Batch *>(rows + groupSize * member))
    , exactRows(reinterpret_cast<double *>(pairs + PairCount(derivatives.shapeModes, derivatives.densityModes, N)))
    , density(reinterpret_cast<Group *>(exactRows + member))
    , shape(density + levels * each * derivatives.densityModes)
  {}

  void
  SetDensity(const CellGroup & group, const GroupFrame & frame, const Derivatives & derivatives) const
  {
    const int   modes = derivatives.densityModes, count = (modes + 1) / 2;
    const Group scale = frame.halfDepth * group.scale;
    Batch       mu[4][4];
    Narrow(frame.mu, mu);
    for (int pair = 0; pair < count; ++pair)
    {
      const double * coefficients[batchSize];
      FindCoefficients(group, derivatives, 2 * pair, coefficients);
      FindCoefficients(group, derivatives, 2 * pair + 1 < modes ? 2 * pair + 1 : 2 * pair, coefficients + groupSize);
      Batch control[CoefficientCount(N)];
      LoadControl<N>(coefficients, Narrow(scale, scale), Batch{}, control);
      Monomials<N, Batch> monomials;
      SetMonomials<N>(control, mu, monomials);
      SetLevels<N>(monomials, Narrow(frame.kappa, frame.kappa), pairs + pair * each, each * count);
    }
    Distribute<each, levels>(pairs, modes, rows, member);
  }

  void
  SetShape(const CellGroup & group, const GroupFrame & frame, const Derivatives & derivatives) const
  {
    const int                 modes = derivatives.shapeModes, count = (modes + 1) / 2;
    const VertexMotion<Group> exact = MotionOf(frame, group.parallel);
    const VertexMotion<Batch> motion = { Narrow(exact.perX, exact.perX),
                                         Narrow(exact.perY, exact.perY),
                                         Narrow(exact.perZ, exact.perZ),
                                         Narrow(exact.c0, exact.c0),
                                         Narrow(exact.r0, exact.r0) };
    Batch                     mu[4][4];
    Narrow(frame.mu, mu);
    for (int pair = 0; pair < count; ++pair)
    {
      const int second = 2 * pair + 1 < modes ? 2 * pair + 1 : 2 * pair;
      Batch     vertex[4][3];
      for (int i = 0; i < 4; ++i)
      {
        Batch moved[groupSize], parts[groupSize];
        for (int g = 0; g < groupSize; ++g)
        {
          const double * const from = derivatives.shape[g < group.count ? g : 0][i];
          moved[g] = Narrow(LoadGroup(from + 6 * pair), LoadGroup(from + 3 * second));
        }
        Transpose(moved, parts);
        for (int k = 0; k < 3; ++k)
        {
          vertex[i][k] = parts[k];
        }
      }
      AffineField<Batch> field;
      SetField(mu, motion, vertex, field);
      SetShapeLevels(field, Narrow(frame.kappa, frame.kappa), pairs + pair * shapeFunctions, shapeFunctions * count);
    }
    Distribute<shapeFunctions, shapeLevels>(
      pairs, modes, rows + RowTableSize(each * derivatives.densityModes, levels), member);
  }

  void
  SetExact(const CellGroup & group, const GroupFrame & frame, const Derivatives & derivatives) const
  {
    for (int m = 0; m < derivatives.densityModes; ++m)
    {
      const double * coefficients[groupSize];
      FindCoefficients(group, derivatives, m, coefficients);
      Group control[CoefficientCount(N)];
      LoadControl<N>(coefficients, frame.halfDepth * group.scale, Group{}, control);
      Monomials<N> monomials;
      SetMonomials<N>(control, frame.mu, monomials);
      SetLevels<N>(monomials, frame.kappa, density + m * each, each * derivatives.densityModes);
    }
    const VertexMotion<Group> motion = MotionOf(frame, group.parallel);
    for (int m = 0; m < derivatives.shapeModes; ++m)
    {
      Group vertex[4][3];
      for (int i = 0; i < 4; ++i)
      {
        Group moved[groupSize], parts[groupSize];
        for (int g = 0; g < groupSize; ++g)
        {
          moved[g] = LoadGroup(derivatives.shape[g < group.count ? g : 0][i] + 3 * m);
        }
        Transpose(moved, parts);
        for (int k = 0; k < 3; ++k)
        {
          vertex[i][k] = parts[k];
        }
      }
      AffineField<Group> field;
      SetField(frame.mu, motion, vertex, field);
      SetShapeLevels(field, frame.kappa, shape + m * shapeFunctions, shapeFunctions * derivatives.shapeModes);
    }
  }

  static void
  PrefetchNext(const Derivatives & derivatives)
  {
    for (int m = 0; m < derivatives.densityModes; ++m)
    {
      for (int g = 0; g < derivatives.nextCount; ++g)
      {
        const double * const start = derivatives.density[m] + derivatives.next[g];
        for (int p = 0; p < CoefficientCount(N) + lanes - 1; p += lanes)
        {
          __builtin_prefetch(start + p);
        }
      }
    }
  }

private:
  static void
  Narrow(const Group (&from)[4][4], Batch (&to)[4][4])
  {
    for (int k = 0; k < 4; ++k)
    {
      for (int i = 0; i < 4; ++i)
      {
        to[k][i] = BONE_PROJECTION_NAMESPACE::Narrow(from[k][i], from[k][i]);
      }
    }
  }
  static Batch
  Narrow(Group low, Group high)
  {
    return BONE_PROJECTION_NAMESPACE::Narrow(low, high);
  }
  static Group
  LoadGroup(const double * from)
  {
    Group value;
    __builtin_memcpy(&value, from, sizeof(value));
    return value;
  }
  static void
  FindCoefficients(const CellGroup & group, const Derivatives & derivatives, int mode, const double ** coefficients)
  {
    for (int g = 0; g < groupSize; ++g)
    {
      coefficients[g] = derivatives.density[mode] + derivatives.coefficient[g < group.count ? g : 0];
    }
  }
};

} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
