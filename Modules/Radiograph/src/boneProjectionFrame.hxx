/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The part of boneProjectionKernel.hxx that does not depend on the density: a tetrahedron seen from the source.

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
constexpr int
CoefficientCount(int degree)
{
  return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

/** Where exponents (i, j+1, k, l), (i, j, k+1, l) and (one further on) (i, j, k, l+1) of a degree stand, for each
 * (i, j, k, l) of the degree below: the position depends on j+k+l, k+l and l alone. (i+1, j, k, l) stays in place. */
struct Raise
{
  int second[CoefficientCount(7)]{};
  int third[CoefficientCount(7)]{};
  constexpr Raise()
  {
    int p = 0;
    for (int jkl = 0; jkl <= 7; ++jkl)
    {
      for (int kl = 0; kl <= jkl; ++kl)
      {
        for (int l = 0; l <= kl; ++l, ++p)
        {
          const int layer = (jkl + 1) * (jkl + 2) * (jkl + 3) / 6;
          second[p] = layer + kl * (kl + 1) / 2 + l;
          third[p] = layer + (kl + 1) * (kl + 2) / 2 + l;
        }
      }
    }
  }
};
constexpr Raise raise;

constexpr double factorial[] = { 1, 1, 2, 6, 24, 120, 720, 5040, 40320 };

template <typename TReal>
struct Vector
{
  typedef TReal Type __attribute__((vector_size(lanes * sizeof(TReal))));
};

/** function(0), ..., function(TCount - 1), unrolled where it is short. */
template <int TCount, int TFirst = 0, typename TFunction>
inline __attribute__((always_inline)) void
Repeat(const TFunction & function)
{
  if constexpr (TCount > 21)
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

/** The same for loops of degrees: unrolled up to degree 3. */
template <int TCount, typename TFunction>
inline __attribute__((always_inline)) void
RepeatDegrees(const TFunction & function)
{
  if constexpr (TCount > 4)
  {
    for (int i = 0; i < TCount; ++i)
    {
      function(i);
    }
  }
  else
  {
    Repeat<TCount>(function);
  }
}

/** out[0..lanes) += value. */
inline void
Accumulate(float * out, const Vector<float>::Type & value)
{
  Vector<float>::Type sum;
  __builtin_memcpy(&sum, out, sizeof(sum));
  sum += value;
  __builtin_memcpy(out, &sum, sizeof(sum));
}
inline void
Accumulate(float * out, const Vector<double>::Type & value)
{
  for (int i = 0; i < lanes; ++i)
  {
    out[i] += static_cast<float>(value[i]);
  }
}

/** Fills a group up, with its first member: the set-up is done for all. */
inline void
Complete(CellGroup & group)
{
  for (int g = group.count; g < groupSize; ++g)
  {
    for (int i = 0; i < 4; ++i)
    {
      group.column[i][g] = group.column[i][0];
      group.row[i][g] = group.row[i][0];
      group.s[i][g] = group.s[i][0];
    }
    group.coefficients[g] = group.coefficients[0];
  }
}

/** One number of each cell of a group. */
typedef double Group __attribute__((vector_size(groupSize * sizeof(double))));

/** One number of each cell of two groups, in single precision. */
constexpr int               batchSize = 2 * groupSize;
typedef Vector<float>::Type Batch;
static_assert(batchSize == lanes, "both are eight");
typedef Vector<double>::Type Octet; ///< the same in double precision

inline Batch
Narrow(const Octet & x)
{
  return __builtin_convertvector(x, Batch);
}

/** The frames of several cells, a number of each in every vector. */
template <typename TLanes>
struct Frames
{
  TLanes c0, r0, s0;
  TLanes halfWidth, halfHeight, halfDepth; ///< wc, wr, h
  TLanes perWidth, perHeight;              ///< their reciprocals
  TLanes columns[2], rows[2];              ///< least and greatest of the vertices
  TLanes kappa;
  TLanes mu[4][4];    ///< columns of the barycentric coordinates as a function of (1, X, Y, z)
  TLanes volume;      ///< in the frame's units, signed
  TLanes slope[4];    ///< v * slope + (mu0 + mu1 xi + mu2 eta) is a barycentric coordinate times 1 + kappa v
  TLanes inPlane[4];  ///< |mu1| + |mu2|
  TLanes depth[4][3]; ///< v of the face planes: constant, per column, per row
};
using GroupFrame = Frames<Group>;

/** A column limit: column >= (left) or <= (right) at + perRow * (row - r0). */
struct Limit
{
  double at;
  double perRow;
};

/** One cell in its frame, what does not depend on the degree. */
struct Frame
{
  double c0, r0;
  double halfWidth, halfHeight;
  double kappa;
  int    firstRow, endRow; ///< rows in the band
  int    firstColumn, endColumn;
  double depth[4][3]; ///< as in Frames, fronts first; where there are less than four, the last one again
  int    face[4];     ///< the vertex opposite to each of these planes
  int    fronts;      ///< 1..3
  bool   steep;       ///< a plane is seen too nearly edge-on for single precision
  Limit  left[6], right[6];
  int    lefts, rights;
};

/** Of barycentric coordinates over a cell's frame, for single precision: how much rounding grows. */
constexpr double largestReach = 64;

inline double
Absolute(double x)
{
  return x < 0 ? -x : x;
}
template <typename TLanes>
inline TLanes
Absolute(const TLanes & x)
{
  return x < 0 ? -x : x;
}

/** Largest integer not above x, within bounds far beyond any detector. */
inline int
Floor(double x)
{
  constexpr int limit = 1 << 30;
  if (!(x > -limit))
  {
    return -limit;
  }
  if (!(x < limit))
  {
    return limit;
  }
  const int i = static_cast<int>(x);
  return i - (static_cast<double>(i) > x ? 1 : 0);
}

inline void
Load(const double (&from)[4][groupSize], Group (&to)[4])
{
  static_assert(sizeof(from) == sizeof(to), "one vertex a vector");
  __builtin_memcpy(to, from, sizeof(to));
}

template <typename TLanes>
inline void
SetRange(const TLanes (&x)[4], TLanes (&range)[2])
{
  range[0] = range[1] = x[0];
  for (int i = 1; i < 4; ++i)
  {
    range[0] = x[i] < range[0] ? x[i] : range[0];
    range[1] = x[i] > range[1] ? x[i] : range[1];
  }
}

template <typename TLanes>
inline void
SetMiddle(const TLanes (&x)[4], TLanes & middle)
{
  TLanes range[2];
  SetRange(x, range);
  middle = 0.5 * (range[0] + range[1]);
}

/** How far a range goes from a place in it. */
template <typename TLanes>
inline TLanes
Extent(const TLanes (&range)[2], const TLanes & from)
{
  const TLanes below = from - range[0], above = range[1] - from;
  return below > above ? below : above;
}

/** The barycentric coordinates in the frame, from the vertices in it. */
template <typename TLanes>
inline void
SetBarycentric(const TLanes (&p)[4][3], Frames<TLanes> & frame)
{
  TLanes e[3][3], normal[3][3];
  for (int i = 0; i < 3; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      e[i][k] = p[i + 1][k] - p[0][k];
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    const TLanes(&u)[3] = e[(i + 1) % 3];
    const TLanes(&v)[3] = e[(i + 2) % 3];
    normal[i][0] = u[1] * v[2] - u[2] * v[1];
    normal[i][1] = u[2] * v[0] - u[0] * v[2];
    normal[i][2] = u[0] * v[1] - u[1] * v[0];
  }
  const TLanes none{};
  frame.volume = e[0][0] * normal[0][0] + e[0][1] * normal[0][1] + e[0][2] * normal[0][2];
  const TLanes inverse = 1.0 / frame.volume;
  frame.mu[0][0] = none + 1.0;
  frame.mu[1][0] = frame.mu[2][0] = frame.mu[3][0] = none;
  for (int i = 0; i < 3; ++i)
  {
    TLanes atCentre = none;
    for (int k = 0; k < 3; ++k)
    {
      const TLanes gradient = normal[i][k] * inverse;
      frame.mu[k + 1][i + 1] = gradient;
      atCentre -= gradient * p[0][k];
      frame.mu[k + 1][0] -= gradient;
    }
    frame.mu[0][i + 1] = atCentre;
    frame.mu[0][0] -= atCentre;
  }
}

/** Everything of Frames, from the vertices and the origin (c0, r0, s0), which is set already. */
template <typename TLanes>
inline void
SetFrames(const TLanes (&column)[4],
          const TLanes (&row)[4],
          const TLanes (&s)[4],
          bool             parallel,
          Frames<TLanes> & frame)
{
  TLanes range[2];
  SetRange(column, frame.columns);
  SetRange(row, frame.rows);
  SetRange(s, range);
  frame.halfWidth = Extent(frame.columns, frame.c0);
  frame.halfHeight = Extent(frame.rows, frame.r0);
  frame.halfDepth = Extent(range, frame.s0);
  const TLanes none{}, perWidth = 1.0 / frame.halfWidth, perHeight = 1.0 / frame.halfHeight;
  frame.perWidth = perWidth;
  frame.perHeight = perHeight;
  const TLanes perDepth = 1.0 / frame.halfDepth, perS = parallel ? none : 1.0 / frame.s0;
  frame.kappa = frame.halfDepth * perS;
  TLanes p[4][3];
  for (int i = 0; i < 4; ++i)
  {
    const TLanes magnification = parallel ? none + 1.0 : s[i] * perS;
    p[i][0] = magnification * (column[i] - frame.c0) * perWidth;
    p[i][1] = magnification * (row[i] - frame.r0) * perHeight;
    p[i][2] = (s[i] - frame.s0) * perDepth;
  }
  SetBarycentric(p, frame);
  for (int i = 0; i < 4; ++i)
  {
    frame.slope[i] = frame.kappa * frame.mu[0][i] - frame.mu[3][i];
    frame.inPlane[i] = Absolute(frame.mu[1][i]) + Absolute(frame.mu[2][i]);
    const TLanes inverse = -1.0 / frame.slope[i];
    frame.depth[i][0] = frame.mu[0][i] * inverse;
    frame.depth[i][1] = frame.mu[1][i] * inverse * perWidth;
    frame.depth[i][2] = frame.mu[2][i] * inverse * perHeight;
  }
}

inline void
SetGroupFrame(const CellGroup & group, GroupFrame & frame)
{
  Group column[4], row[4], s[4];
  Load(group.column, column);
  Load(group.row, row);
  Load(group.s, s);
  SetMiddle(column, frame.c0);
  SetMiddle(row, frame.r0);
  SetMiddle(s, frame.s0);
  SetFrames(column, row, s, group.parallel, frame);
}

/** Pixels of one cell of a group; false where it meets none of the band or is flat. */
template <typename TLanes>
inline bool
PlaceFrame(const Frames<TLanes> & group, int member, const Band & band, Frame & frame)
{
  frame.c0 = group.c0[member];
  frame.r0 = group.r0[member];
  frame.halfWidth = group.halfWidth[member];
  frame.halfHeight = group.halfHeight[member];
  frame.kappa = group.kappa[member];
  // Not from centre and half extent, which are rounded: a face that lies along a row must end there.
  const int firstRow = -Floor(-group.rows[0][member]), endRow = Floor(group.rows[1][member]) + 1;
  const int firstColumn = -Floor(-group.columns[0][member]), endColumn = Floor(group.columns[1][member]) + 1;
  frame.firstRow = firstRow < band.firstRow ? band.firstRow : firstRow;
  frame.endRow = endRow > band.endRow ? band.endRow : endRow;
  frame.firstColumn = firstColumn < band.firstColumn ? band.firstColumn : firstColumn;
  frame.endColumn = endColumn > band.columns ? band.columns : endColumn;
  return frame.firstRow < frame.endRow && frame.firstColumn < frame.endColumn && frame.halfWidth > 0 &&
         frame.halfHeight > 0 && group.halfDepth[member] > 0 && Absolute(group.volume[member]) > 0;
}

inline void
AddLimit(Frame & frame, double constant, double perColumn, double perRow, double margin)
{
  // constant + perColumn (c - c0) + perRow (r - r0) >= 0
  constexpr double tiny = 1e-30;
  if (!(Absolute(perColumn) > tiny))
  {
    return;
  }
  const double inverse = -1.0 / perColumn, at = frame.c0 + constant * inverse;
  if (perColumn > 0)
  {
    frame.left[frame.lefts++] = { at - margin, perRow * inverse };
  }
  else
  {
    frame.right[frame.rights++] = { at + margin, perRow * inverse };
  }
}

/** Depths of the face planes and column limits; false where there is nothing to be seen. */
template <typename TLanes>
inline bool
SetPlanes(const Frames<TLanes> & group, int member, Frame & frame)
{
  // Seen more nearly edge-on than that (in units of the cell's size): not a matter of depth but of left and right.
  constexpr double edgeOn = 1e-10;
  constexpr double steep = 1e-3;
  int              order[4]; // fronts from the left, backs from the right
  int              fronts = 0, backs = 0;
  frame.lefts = frame.rights = 0;
  frame.steep = false;
  for (int i = 0; i < 4; ++i)
  {
    const double slope = group.slope[i][member], inPlane = group.inPlane[i][member];
    if (Absolute(slope) <= edgeOn * inPlane)
    {
      AddLimit(frame,
               group.mu[0][i][member],
               group.mu[1][i][member] / frame.halfWidth,
               group.mu[2][i][member] / frame.halfHeight,
               0.0);
      continue;
    }
    frame.steep = frame.steep || Absolute(slope) < steep * inPlane;
    order[slope < 0 ? fronts++ : 3 - backs++] = i;
  }
  if (fronts == 0 || backs == 0)
  {
    return false;
  }
  for (int i = fronts; i < 4 - backs; ++i)
  {
    order[i] = order[3];
  }
  for (int i = 0; i < 4; ++i)
  {
    frame.face[i] = order[i];
    for (int k = 0; k < 3; ++k)
    {
      frame.depth[i][k] = group.depth[order[i]][k][member];
    }
  }
  constexpr double margin = 1e-3;
  for (int f = 0; f < fronts; ++f)
  {
    for (int b = 4 - backs; b < 4; ++b)
    {
      AddLimit(frame,
               frame.depth[f][0] - frame.depth[b][0],
               frame.depth[f][1] - frame.depth[b][1],
               frame.depth[f][2] - frame.depth[b][2],
               margin);
    }
  }
  frame.fronts = fronts;
  return true;
}

/** The columns that the cell may cover in each of some rows. */
struct RowRuns
{
  int first[lanes];
  int count[lanes]; ///< 0 or less: none
};

inline void
SetRowRuns(const Frame & frame, int firstRow, RowRuns & runs)
{
  using Rows __attribute__((vector_size(lanes * sizeof(double)))) = double;
  using Columns __attribute__((vector_size(lanes * sizeof(int)))) = int;
  const Rows index = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const Rows dr = index + (firstRow - frame.r0), none{};
  Rows       low = none + static_cast<double>(frame.firstColumn), high = none + (frame.endColumn - 1.0);
  for (int i = 0; i < frame.lefts; ++i)
  {
    const Rows x = frame.left[i].at + frame.left[i].perRow * dr;
    low = x > low ? x : low;
  }
  for (int i = 0; i < frame.rights; ++i)
  {
    const Rows x = frame.right[i].at + frame.right[i].perRow * dr;
    high = x < high ? x : high;
  }
  // What lies outside [firstColumn, endColumn) is none, whatever it is cut to.
  low = low < frame.endColumn + none ? low : frame.endColumn + none;
  high = high > frame.firstColumn - 1 + none ? high : frame.firstColumn - 1 + none;
  const Columns down = __builtin_convertvector(low, Columns);
  const Columns first =
    __builtin_convertvector(low > __builtin_convertvector(down, Rows) ? none + 1 : none, Columns) + down;
  const Columns count = __builtin_convertvector(high + 1, Columns) - first;
  __builtin_memcpy(runs.first, &first, sizeof(first));
  __builtin_memcpy(runs.count, &count, sizeof(count));
}

} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
