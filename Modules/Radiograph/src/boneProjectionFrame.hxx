/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// The part of boneProjectionKernel.hxx, which see, that knows nothing of the density: a tetrahedron seen from the
// source.

namespace bone
{
namespace projection
{
namespace BONE_PROJECTION_NAMESPACE
{
/** A column limit: column >= (left) or <= (right) at + perRow * (row - r0). */
struct Limit
{
  double at;
  double perRow;
};

/** One cell in its frame, what does not depend on the degree. */
struct Frame
{
  double c0, r0, s0;
  double halfWidth, halfHeight, halfDepth; ///< wc, wr, h
  double kappa;
  int    firstRow, endRow; ///< rows in the band
  int    firstColumn, endColumn;
  double mu[4][4];    ///< columns of the barycentric coordinates as a function of (1, X, Y, z)
  double depth[4][3]; ///< depths v of the face planes: constant, per column, per row; fronts first
  int    fronts;      ///< 1..3
  bool   steep;       ///< a plane is seen too nearly edge-on for single precision
  Limit  left[6], right[6];
  int    lefts, rights;
};

inline double
Absolute(double x)
{
  return x < 0 ? -x : x;
}

/** Largest integer not above x, within +-limit. */
inline int
Floor(double x, int limit)
{
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
Range(const double (&x)[4], double & low, double & high)
{
  low = high = x[0];
  for (int i = 1; i < 4; ++i)
  {
    low = x[i] < low ? x[i] : low;
    high = x[i] > high ? x[i] : high;
  }
}

/** Centre, size and pixels of the cell; false where it meets no pixel of the band or is flat. */
inline bool
PlaceFrame(const Cell & cell, const Band & band, Frame & frame)
{
  double low[3], high[3];
  Range(cell.column, low[0], high[0]);
  Range(cell.row, low[1], high[1]);
  Range(cell.s, low[2], high[2]);
  constexpr int limit = 1 << 30;
  const int     firstRow = Floor(low[1], limit) + (Floor(low[1], limit) < low[1] ? 1 : 0);
  const int     endRow = Floor(high[1], limit) + 1;
  const int     firstColumn = Floor(low[0], limit) + (Floor(low[0], limit) < low[0] ? 1 : 0);
  const int     endColumn = Floor(high[0], limit) + 1;
  frame.firstRow = firstRow < band.firstRow ? band.firstRow : firstRow;
  frame.endRow = endRow > band.endRow ? band.endRow : endRow;
  frame.firstColumn = firstColumn < 0 ? 0 : firstColumn;
  frame.endColumn = endColumn > band.columns ? band.columns : endColumn;
  frame.c0 = 0.5 * (low[0] + high[0]);
  frame.r0 = 0.5 * (low[1] + high[1]);
  frame.s0 = 0.5 * (low[2] + high[2]);
  frame.halfWidth = 0.5 * (high[0] - low[0]);
  frame.halfHeight = 0.5 * (high[1] - low[1]);
  frame.halfDepth = 0.5 * (high[2] - low[2]);
  frame.kappa = cell.parallel ? 0.0 : frame.halfDepth / frame.s0;
  return frame.firstRow < frame.endRow && frame.firstColumn < frame.endColumn && frame.halfWidth > 0 &&
         frame.halfHeight > 0 && frame.halfDepth > 0;
}

/** Barycentric coordinates in the frame; false for a flat cell. */
inline bool
SetBarycentric(const Cell & cell, Frame & frame)
{
  double p[4][3];
  for (int i = 0; i < 4; ++i)
  {
    const double magnification = cell.parallel ? 1.0 : cell.s[i] / frame.s0;
    p[i][0] = magnification * (cell.column[i] - frame.c0) / frame.halfWidth;
    p[i][1] = magnification * (cell.row[i] - frame.r0) / frame.halfHeight;
    p[i][2] = (cell.s[i] - frame.s0) / frame.halfDepth;
  }
  double e[3][3], normal[3][3];
  for (int i = 0; i < 3; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      e[i][k] = p[i + 1][k] - p[0][k];
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    const double(&u)[3] = e[(i + 1) % 3];
    const double(&v)[3] = e[(i + 2) % 3];
    normal[i][0] = u[1] * v[2] - u[2] * v[1];
    normal[i][1] = u[2] * v[0] - u[0] * v[2];
    normal[i][2] = u[0] * v[1] - u[1] * v[0];
  }
  const double volume = e[0][0] * normal[0][0] + e[0][1] * normal[0][1] + e[0][2] * normal[0][2];
  if (!(Absolute(volume) > 0))
  {
    return false;
  }
  const double inverse = 1.0 / volume;
  frame.mu[0][0] = 1;
  frame.mu[1][0] = frame.mu[2][0] = frame.mu[3][0] = 0;
  for (int i = 0; i < 3; ++i)
  {
    double atCentre = 0;
    for (int k = 0; k < 3; ++k)
    {
      frame.mu[k + 1][i + 1] = normal[i][k] * inverse;
      atCentre -= normal[i][k] * inverse * p[0][k];
      frame.mu[k + 1][0] -= normal[i][k] * inverse;
    }
    frame.mu[0][i + 1] = atCentre;
    frame.mu[0][0] -= atCentre;
  }
  return true;
}

inline void
AddLimit(Frame & frame, double constant, double perColumn, double perRow, double margin)
{
  // constant + perColumn (c - c0) + perRow (r - r0) >= 0
  constexpr double tiny = 1e-30;
  const double     slope = Absolute(perColumn) > tiny ? perColumn : tiny;
  const double     at = frame.c0 - constant / slope;
  if (slope > 0)
  {
    frame.left[frame.lefts++] = { at - margin, -perRow / slope };
  }
  else
  {
    frame.right[frame.rights++] = { at + margin, -perRow / slope };
  }
}

/** Depths of the face planes and column limits; false where there is nothing to be seen. */
inline bool
SetPlanes(Frame & frame)
{
  // Seen more nearly edge-on than that (in units of the cell's size): not a matter of depth but of left and right.
  constexpr double edgeOn = 1e-10;
  constexpr double steep = 1e-3;
  double           front[4][3], back[4][3];
  int              fronts = 0, backs = 0;
  frame.lefts = frame.rights = 0;
  frame.steep = false;
  for (int i = 0; i < 4; ++i)
  {
    // v * slope + (mu0 + mu1 xi + mu2 eta) >= 0 inside
    const double slope = frame.kappa * frame.mu[0][i] - frame.mu[3][i];
    const double inPlane = Absolute(frame.mu[1][i]) + Absolute(frame.mu[2][i]);
    const double perColumn = frame.mu[1][i] / frame.halfWidth, perRow = frame.mu[2][i] / frame.halfHeight;
    if (Absolute(slope) <= edgeOn * inPlane)
    {
      AddLimit(frame, frame.mu[0][i], perColumn, perRow, 0.0);
      continue;
    }
    frame.steep = frame.steep || Absolute(slope) < steep * inPlane;
    double(&plane)[3] = slope < 0 ? front[fronts++] : back[backs++];
    plane[0] = -frame.mu[0][i] / slope;
    plane[1] = -perColumn / slope;
    plane[2] = -perRow / slope;
  }
  if (fronts == 0 || backs == 0)
  {
    return false;
  }
  constexpr double margin = 1e-3;
  for (int f = 0; f < fronts; ++f)
  {
    for (int b = 0; b < backs; ++b)
    {
      AddLimit(frame, front[f][0] - back[b][0], front[f][1] - back[b][1], front[f][2] - back[b][2], margin);
    }
  }
  frame.fronts = fronts;
  for (int i = 0; i < 4; ++i)
  {
    const double(&plane)[3] = i < fronts ? front[i] : back[i - fronts < backs ? i - fronts : backs - 1];
    for (int k = 0; k < 3; ++k)
    {
      frame.depth[i][k] = plane[k];
    }
  }
  return true;
}

/** Columns [first, end) that the cell may cover in a row. */
inline void
RowColumns(const Frame & frame, double dr, int & first, int & end)
{
  double low = frame.firstColumn, high = frame.endColumn - 1;
  for (int i = 0; i < frame.lefts; ++i)
  {
    const double x = frame.left[i].at + frame.left[i].perRow * dr;
    low = x > low ? x : low;
  }
  for (int i = 0; i < frame.rights; ++i)
  {
    const double x = frame.right[i].at + frame.right[i].perRow * dr;
    high = x < high ? x : high;
  }
  if (!(low <= high))
  {
    first = end = 0;
    return;
  }
  first = static_cast<int>(low);
  first += first < low ? 1 : 0;
  end = static_cast<int>(high) + 1;
}

} // namespace BONE_PROJECTION_NAMESPACE
} // namespace projection
} // namespace bone
