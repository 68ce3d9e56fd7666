/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTetraLocator.h"

#include "bonePredicates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr int MaximumSteps = 64;      // of a walk; beyond it the grid is faster
constexpr int MaximumBoxes = 1 << 24; // of the grid
} // namespace

TetraLocator::TetraLocator(const MeshArrays & mesh)
{
  m_Mesh.points = mesh.points;
  m_Mesh.tetrahedra = mesh.tetrahedra;
  m_Mesh.neighbors =
    mesh.neighbors.size() == mesh.tetrahedra.size() ? mesh.neighbors : ComputeFaceNeighbors(mesh.tetrahedra);
  if (!std::all_of(m_Mesh.points.begin(), m_Mesh.points.end(), [](const Vector3 & p) { return p.allFinite(); }))
  {
    throw std::invalid_argument("TetraLocator: a point of the mesh is not finite.");
  }
  this->BuildCells();
  this->BuildGrid();
  this->BuildBoundary();
}

void
TetraLocator::BuildCells()
{
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  m_Cells.resize(m_Mesh.tetrahedra.size());
  for (std::size_t t = 0; t < m_Cells.size(); ++t)
  {
    const Id4 &     v = m_Mesh.tetrahedra[t];
    const Vector3 & a = m_Mesh.points[v[0]];
    const Vector3   u1 = m_Mesh.points[v[1]] - a, u2 = m_Mesh.points[v[2]] - a, u3 = m_Mesh.points[v[3]] - a;
    Cell &          cell = m_Cells[t];
    cell.lower = cell.upper = a;
    for (int i = 1; i < 4; ++i)
    {
      cell.lower = cell.lower.cwiseMin(m_Mesh.points[v[i]]);
      cell.upper = cell.upper.cwiseMax(m_Mesh.points[v[i]]);
    }
    const double determinant = u1.cross(u2).dot(u3);
    const double scale = 1.0 / determinant;
    cell.inverse.row(0) = u2.cross(u3) * scale;
    cell.inverse.row(1) = u3.cross(u1) * scale;
    cell.inverse.row(2) = u1.cross(u2) * scale;
    // Every mu is a quotient of determinants of vectors no longer than the box's diagonal.
    const double diagonal = (cell.upper - cell.lower).norm();
    cell.tolerance = 64 * epsilon * diagonal * diagonal * diagonal * std::abs(scale);
    const bool doubtful = !(cell.tolerance < 1e-3) || determinant <= 0;
    if (doubtful && Orient3D(m_Mesh.points[v[0]], m_Mesh.points[v[1]], m_Mesh.points[v[2]], m_Mesh.points[v[3]]) <= 0)
    {
      cell.tolerance = std::numeric_limits<double>::infinity();
    }
    else if (doubtful)
    {
      cell.tolerance = std::numeric_limits<double>::max(); // positive, but too flat for anything but predicates
    }
  }
}

int
TetraLocator::GridIndex(int axis, double x) const
{
  const double box = std::floor((x - m_Lower[axis]) * m_BoxesPerMm[axis]);
  return static_cast<int>(std::min(std::max(box, 0.0), m_Size[axis] - 1.0));
}

template <typename TVisitor>
void
TetraLocator::VisitBoxes(IdType t, const TVisitor & visit) const
{
  const Cell & cell = m_Cells[t];
  if (std::isinf(cell.tolerance))
  {
    return;
  }
  std::array<int, 3> first, last;
  for (int axis = 0; axis < 3; ++axis)
  {
    first[axis] = this->GridIndex(axis, cell.lower[axis]);
    last[axis] = this->GridIndex(axis, cell.upper[axis]);
  }
  // A box that lies wholly beyond one face is left out; the margin is far above rounding.
  const bool      few = (last[0] - first[0]) + (last[1] - first[1]) + (last[2] - first[2]) <= 1;
  const bool      cull = !few && cell.tolerance < 1e-6;
  const Vector3   size = m_BoxesPerMm.cwiseInverse();
  const Vector3   half = 0.5 * cell.inverse.cwiseAbs() * size;
  const Vector3   sum = cell.inverse.colwise().sum();
  const double    half0 = 0.5 * sum.cwiseAbs().dot(size);
  const Vector3 & a = m_Mesh.points[m_Mesh.tetrahedra[t][0]];
  for (int k = first[2]; k <= last[2]; ++k)
  {
    for (int j = first[1]; j <= last[1]; ++j)
    {
      for (int i = first[0]; i <= last[0]; ++i)
      {
        if (cull)
        {
          const Vector3 centre = m_Lower + Vector3(i + 0.5, j + 0.5, k + 0.5).cwiseProduct(size);
          const Vector3 mu = cell.inverse * (centre - a);
          if ((mu + half).minCoeff() < -1e-3 || 1 - mu.sum() + half0 < -1e-3)
          {
            continue;
          }
        }
        visit((static_cast<std::size_t>(k) * m_Size[1] + j) * m_Size[0] + i);
      }
    }
  }
}

void
TetraLocator::BuildGrid()
{
  if (m_Cells.empty())
  {
    return;
  }
  m_Lower = m_Cells[0].lower;
  m_Upper = m_Cells[0].upper;
  double volume = 0;
  for (const Cell & cell : m_Cells)
  {
    m_Lower = m_Lower.cwiseMin(cell.lower);
    m_Upper = m_Upper.cwiseMax(cell.upper);
    volume += (cell.upper - cell.lower).prod() / 6; // about that of the tetrahedron
  }
  const Vector3 extent = (m_Upper - m_Lower).cwiseMax(1e-9 * (m_Upper - m_Lower).maxCoeff() + 1e-300);
  const double  boxVolume = extent.prod();
  const double  wanted = static_cast<double>(m_Cells.size()) * std::min(8.0, boxVolume / std::max(volume, 1e-300));
  const double  width = std::cbrt(boxVolume / std::min(wanted, static_cast<double>(MaximumBoxes)));
  for (int axis = 0; axis < 3; ++axis)
  {
    m_Size[axis] = static_cast<int>(std::min(std::max(std::ceil(extent[axis] / width), 1.0), 1024.0));
    m_BoxesPerMm[axis] = m_Size[axis] / extent[axis];
  }
  m_Start.assign(static_cast<std::size_t>(m_Size[0]) * m_Size[1] * m_Size[2] + 1, 0);
  const IdType count = static_cast<IdType>(m_Cells.size());
  for (IdType t = 0; t < count; ++t)
  {
    this->VisitBoxes(t, [this](std::size_t box) { ++m_Start[box + 1]; });
  }
  for (std::size_t box = 1; box < m_Start.size(); ++box)
  {
    m_Start[box] += m_Start[box - 1];
  }
  m_List.resize(m_Start.back());
  std::vector<IdType> next(m_Start.begin(), m_Start.end() - 1);
  for (IdType t = 0; t < count; ++t)
  {
    this->VisitBoxes(t, [&](std::size_t box) { m_List[next[box]++] = t; });
  }
}

void
TetraLocator::BuildBoundary()
{
  std::vector<TriangleTree::Triangle> triangles;
  for (std::size_t t = 0; t < m_Mesh.tetrahedra.size(); ++t)
  {
    for (int side = 0; side < 4; ++side)
    {
      if (m_Mesh.neighbors[t][side] < 0)
      {
        const Id4 &  v = m_Mesh.tetrahedra[t];
        const auto & face = TetraFaces[side];
        triangles.push_back({ m_Mesh.points[v[face[0]]], m_Mesh.points[v[face[1]]], m_Mesh.points[v[face[2]]] });
        m_BoundaryFace.emplace_back(static_cast<IdType>(t), side);
      }
    }
  }
  m_Boundary = TriangleTree(std::move(triangles));
}

Barycentric
TetraLocator::Coordinates(IdType t, const Vector3 & x) const
{
  const Vector3 mu = m_Cells[t].inverse * (x - m_Mesh.points[m_Mesh.tetrahedra[t][0]]);
  return { 1.0 - mu.sum(), mu[0], mu[1], mu[2] };
}

bool
TetraLocator::Contains(IdType t, const Vector3 & x, Barycentric & mu) const
{
  const Cell & cell = m_Cells[t];
  if ((x.array() < cell.lower.array()).any() || (x.array() > cell.upper.array()).any() || std::isinf(cell.tolerance))
  {
    return false;
  }
  mu = this->Coordinates(t, x);
  const double least = mu.minCoeff();
  if (least > cell.tolerance)
  {
    return true;
  }
  if (least < -cell.tolerance)
  {
    return false;
  }
  const Id4 & v = m_Mesh.tetrahedra[t];
  for (int side = 0; side < 4; ++side)
  {
    const auto & face = TetraFaces[side];
    if (Orient3D(m_Mesh.points[v[face[0]]], m_Mesh.points[v[face[1]]], m_Mesh.points[v[face[2]]], x) > 0)
    {
      return false;
    }
  }
  // Inside for certain; what rounding has left below 0 is cleared. (Not of use where the cell is flat to rounding.)
  mu = mu.cwiseMax(0.0);
  mu = mu.allFinite() && mu.sum() > 0 ? Barycentric(mu / mu.sum()) : Barycentric::Constant(0.25);
  return true;
}

bool
TetraLocator::WalkTo(const Vector3 & x, IdType start, CellLocation & location) const
{
  IdType t = start;
  for (int step = 0; step < MaximumSteps && t >= 0 && m_Cells[t].tolerance < 1e-3; ++step)
  {
    const Barycentric mu = this->Coordinates(t, x);
    int               lowest;
    if (mu.minCoeff(&lowest) > m_Cells[t].tolerance)
    {
      location.cell = t;
      location.mu = mu;
      return true;
    }
    if (mu[lowest] >= -m_Cells[t].tolerance)
    {
      return false; // on a face to rounding: the grid decides whose it is
    }
    t = m_Mesh.neighbors[t][lowest];
  }
  return false;
}

CellLocation
TetraLocator::Find(const Vector3 & x, IdType hint) const
{
  CellLocation location;
  if (m_Cells.empty() || !((x.array() >= m_Lower.array()).all() && (x.array() <= m_Upper.array()).all()))
  {
    return location;
  }
  if (hint >= 0 && hint < static_cast<IdType>(m_Cells.size()) && this->WalkTo(x, hint, location))
  {
    return location;
  }
  const std::size_t box =
    (static_cast<std::size_t>(this->GridIndex(2, x[2])) * m_Size[1] + this->GridIndex(1, x[1])) * m_Size[0] +
    this->GridIndex(0, x[0]);
  for (IdType entry = m_Start[box]; entry < m_Start[box + 1]; ++entry)
  {
    if (this->Contains(m_List[entry], x, location.mu))
    {
      location.cell = m_List[entry];
      return location;
    }
  }
  location.mu.setZero();
  return location;
}

CellLocation
TetraLocator::FindNearest(const Vector3 & x, IdType hint) const
{
  CellLocation location = this->Find(x, hint);
  if (location.Found() || m_Boundary.IsEmpty() || !x.allFinite())
  {
    return location;
  }
  const TriangleTree::Nearest nearest = m_Boundary.FindNearest(x);
  const auto &                found = m_BoundaryFace[nearest.triangle];
  const auto &                face = TetraFaces[found.second];
  const Id4 &                 v = m_Mesh.tetrahedra[found.first];
  // Coordinates within the face by least squares: no flat tetrahedron can spoil them.
  const Vector3 a = m_Mesh.points[v[face[0]]], u = m_Mesh.points[v[face[1]]] - a, w = m_Mesh.points[v[face[2]]] - a;
  const Vector3 r = nearest.point - a;
  const double  uu = u.dot(u), uw = u.dot(w), ww = w.dot(w), determinant = uu * ww - uw * uw;
  double        s = 0, q = 0;
  if (determinant > 0)
  {
    s = std::clamp((ww * r.dot(u) - uw * r.dot(w)) / determinant, 0.0, 1.0);
    q = std::clamp((uu * r.dot(w) - uw * r.dot(u)) / determinant, 0.0, 1.0 - s);
  }
  location.cell = found.first;
  location.mu[face[0]] = 1 - s - q;
  location.mu[face[1]] = s;
  location.mu[face[2]] = q;
  location.distance = std::sqrt(nearest.squaredDistance);
  return location;
}
} // namespace bone
