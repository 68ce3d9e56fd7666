/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCutIntegrals.h"

#include "boneCellPiece.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
/** A piece of a tetrahedron that is wholly inside, or that the capsule's surface may pass. */
struct SolidPiece
{
  IdType    cell{ 0 };
  CellPiece corners;
  double    size{ 0.0 };        // its own volume
  double    volume{ 0.0 };      // of its part in the solid
  double    volumeError{ 0.0 }; // 0: the surface does not pass
  double    level{ 0.0 };       // of the interpolated distance, up to which the piece is best taken as inside
};

class SolidIntegrator
{
public:
  SolidIntegrator(const MeshArrays & mesh, const Solid & solid)
    : m_Mesh(mesh)
    , m_Solid(solid)
    , m_HasDensity(mesh.HasDensity())
    , m_Row(m_HasDensity ? BernsteinCount(mesh.maximumDegree) : 0)
  {}

  /** The parts of a tetrahedron that lie in all half-spaces. */
  std::vector<SolidPiece>
  CutByPlanes(IdType cell) const
  {
    std::vector<CellPiece> pieces{ WholeCell() }, kept;
    for (const HalfSpace & half : m_Solid.halfSpaces)
    {
      kept.clear();
      Eigen::Vector4d corner;
      for (int i = 0; i < 4; ++i)
      {
        corner[i] = half.normal.dot(m_Mesh.points[m_Mesh.tetrahedra[cell][i]] - half.point);
      }
      for (const CellPiece & piece : pieces)
      {
        KeepNotNegative(
          piece, { corner.dot(piece[0]), corner.dot(piece[1]), corner.dot(piece[2]), corner.dot(piece[3]) }, kept);
      }
      pieces.swap(kept);
    }
    std::vector<SolidPiece> result;
    for (const CellPiece & piece : pieces)
    {
      const double volume = PieceShare(piece) * this->CellVolume(cell);
      result.push_back({ cell, piece, volume, volume, 0.0, std::numeric_limits<double>::infinity() });
    }
    return result;
  }

  /** Measures a piece's part in the capsule, with bounds. Returns false where there is none. */
  bool
  CutByCapsule(SolidPiece & piece) const
  {
    const Capsule &        capsule = *m_Solid.capsule;
    std::array<Vector3, 4> x;
    const Eigen::Vector4d  distance = this->CornerDistances(piece, x);
    const Vector3          middle = 0.25 * (x[0] + x[1] + x[2] + x[3]);
    double                 reach = 0.0;
    for (const Vector3 & corner : x)
    {
      reach = std::max(reach, (corner - middle).norm());
    }
    const double middleDistance = capsule.Distance(middle);
    if (middleDistance >= reach)
    {
      return false;
    }
    piece.volume = piece.size;
    piece.volumeError = 0.0;
    piece.level = std::numeric_limits<double>::infinity();
    if (distance.maxCoeff() <= 0.0)
    {
      return true; // convex: all of it is inside
    }
    const double axisDistance = middleDistance + capsule.radius - reach;
    if (!(axisDistance > 0.0))
    {
      piece.volumeError = std::abs(piece.size); // nothing is known of the distance between the corners
      return true;
    }
    const double bound = 0.5 * reach * reach / axisDistance;
    const double inside = ShareBelow(distance, 0.0), outside = ShareBelow(distance, bound);
    piece.level = std::min(this->Sag(x, distance), bound);
    const double share = ShareBelow(distance, piece.level);
    piece.volume = share * piece.size;
    piece.volumeError = std::max(share - inside, outside - share) * std::abs(piece.size);
    return outside > 0.0;
  }

  /** Integral of the density over the part of a piece in the solid. */
  double
  Mass(const SolidPiece & piece) const
  {
    std::vector<CellPiece> parts{ piece.corners };
    if (std::isfinite(piece.level))
    {
      parts.clear();
      std::array<Vector3, 4> x;
      KeepNotNegative(piece.corners, Eigen::Vector4d::Constant(piece.level) - this->CornerDistances(piece, x), parts);
    }
    const int      degree = m_Mesh.degree[piece.cell];
    const double * c = m_Mesh.coefficients.data() + static_cast<std::size_t>(piece.cell) * m_Row;
    double         mass = 0.0;
    for (const CellPiece & part : parts)
    {
      mass += PieceShare(part) * SimplexMean(degree, c, part.data(), 4);
    }
    return mass * this->CellVolume(piece.cell);
  }

  /** Absolute value of each tetrahedron's mean density; empty without a density. */
  std::vector<double>
  MeanDensities() const
  {
    std::vector<double> means(m_HasDensity ? m_Mesh.tetrahedra.size() : 0, 0.0);
    for (std::size_t t = 0; t < means.size(); ++t)
    {
      means[t] = std::abs(BernsteinIntegral(m_Mesh.degree[t], m_Mesh.coefficients.data() + t * m_Row, 1.0));
    }
    return means;
  }

  /** Bound of the density's absolute value in each tetrahedron; empty without a density. */
  std::vector<double>
  LargestDensities() const
  {
    std::vector<double> largest(m_HasDensity ? m_Mesh.tetrahedra.size() : 0, 0.0);
    for (std::size_t t = 0; t < largest.size(); ++t)
    {
      for (int i = 0; i < BernsteinCount(m_Mesh.degree[t]); ++i)
      {
        largest[t] = std::max(largest[t], std::abs(m_Mesh.coefficients[t * m_Row + i]));
      }
    }
    return largest;
  }

  /** Halves a piece at its longest edge. */
  std::array<SolidPiece, 2>
  Bisect(const SolidPiece & piece) const
  {
    int    edge = 0;
    double longest = -1.0;
    for (int e = 0; e < 6; ++e)
    {
      const double length = (this->Place(piece.cell, piece.corners[TetraEdges[e][0]]) -
                             this->Place(piece.cell, piece.corners[TetraEdges[e][1]]))
                              .squaredNorm();
      if (length > longest)
      {
        longest = length;
        edge = e;
      }
    }
    const auto [a, b] = TetraEdges[edge];
    const Barycentric         middle = 0.5 * (piece.corners[a] + piece.corners[b]);
    std::array<SolidPiece, 2> halves{ piece, piece };
    halves[0].corners[a] = middle;
    halves[1].corners[b] = middle;
    halves[0].size = halves[1].size = 0.5 * piece.size;
    return halves;
  }

private:
  Vector3
  Place(IdType cell, const Barycentric & mu) const
  {
    const Id4 & t = m_Mesh.tetrahedra[cell];
    return mu[0] * m_Mesh.points[t[0]] + mu[1] * m_Mesh.points[t[1]] + mu[2] * m_Mesh.points[t[2]] +
           mu[3] * m_Mesh.points[t[3]];
  }

  Eigen::Vector4d
  CornerDistances(const SolidPiece & piece, std::array<Vector3, 4> & x) const
  {
    Eigen::Vector4d distance;
    for (int i = 0; i < 4; ++i)
    {
      x[i] = this->Place(piece.cell, piece.corners[i]);
      distance[i] = m_Solid.capsule->Distance(x[i]);
    }
    return distance;
  }

  double
  CellVolume(IdType cell) const
  {
    const Id4 & t = m_Mesh.tetrahedra[cell];
    return SignedVolume(m_Mesh.points[t[0]], m_Mesh.points[t[1]], m_Mesh.points[t[2]], m_Mesh.points[t[3]]);
  }

  static double
  ShareBelow(const Eigen::Vector4d & distance, double level)
  {
    return ShareNotNegative(Eigen::Vector4d::Constant(level) - distance);
  }

  /** How far the linear interpolant is above the distance where it is 0: by the quadratic interpolant, in the middle
   * of the polygon. */
  double
  Sag(const std::array<Vector3, 4> & x, const Eigen::Vector4d & distance) const
  {
    const auto polygon = ZeroPolygon(WholeCell(), distance);
    if (polygon.empty())
    {
      return 0.0;
    }
    Barycentric mu = Barycentric::Zero();
    for (const Barycentric & corner : polygon)
    {
      mu += corner / static_cast<double>(polygon.size());
    }
    double sag = 0.0;
    for (const auto & [a, b] : TetraEdges)
    {
      const double middle = m_Solid.capsule->Distance(0.5 * (x[a] + x[b]));
      sag += 4.0 * mu[a] * mu[b] * (0.5 * (distance[a] + distance[b]) - middle);
    }
    return std::max(sag, 0.0);
  }

  const MeshArrays & m_Mesh;
  const Solid &      m_Solid;
  bool               m_HasDensity;
  int                m_Row;
};

/** Bisects pieces that the surface may pass until their bounds are small enough. */
void
RefineSolid(const SolidIntegrator &   integrator,
            std::vector<SolidPiece> & pieces,
            double                    relativeError,
            const Execution &         execution,
            std::size_t               mostPieces)
{
  const std::vector<double> largest = integrator.LargestDensities(), means = integrator.MeanDensities();
  const auto                massOf = [](const SolidPiece & piece, double volume, const std::vector<double> & density) {
    return density.empty() ? 0.0 : volume * density[piece.cell];
  };
  for (;;)
  {
    double      volume = 0.0, mass = 0.0, volumeError = 0.0, massError = 0.0;
    std::size_t passed = 0;
    for (const SolidPiece & piece : pieces)
    {
      volume += piece.volume;
      mass += massOf(piece, std::abs(piece.volume), means);
      volumeError += piece.volumeError;
      massError += massOf(piece, piece.volumeError, largest);
      passed += piece.volumeError > 0.0 ? 1 : 0;
    }
    const bool volumeDone = volumeError <= relativeError * std::abs(volume);
    const bool massDone = massError <= relativeError * mass;
    if ((volumeDone && massDone) || passed == 0 || passed > mostPieces)
    {
      return;
    }
    // Those above half an equal share of the error now are halved.
    const double            volumeLimit = volumeDone ? volumeError : 0.5 * volumeError / static_cast<double>(passed);
    const double            massLimit = massDone ? massError : 0.5 * massError / static_cast<double>(passed);
    std::vector<SolidPiece> next, halves;
    for (const SolidPiece & piece : pieces)
    {
      if (piece.volumeError > volumeLimit || massOf(piece, piece.volumeError, largest) > massLimit)
      {
        for (const SolidPiece & half : integrator.Bisect(piece))
        {
          halves.push_back(half);
        }
      }
      else
      {
        next.push_back(piece);
      }
    }
    std::vector<char> meets(halves.size());
    execution.For(
      halves.size(), [&](std::size_t i) { meets[i] = integrator.CutByCapsule(halves[i]) ? 1 : 0; }, 256);
    for (std::size_t i = 0; i < halves.size(); ++i)
    {
      if (meets[i])
      {
        next.push_back(halves[i]);
      }
    }
    pieces.swap(next);
  }
}

/** The parts of the mesh in the half-spaces and, where there is a capsule, those that it may hold something of. */
std::vector<SolidPiece>
CutMesh(const SolidIntegrator & integrator, std::size_t cells, bool hasCapsule, const Execution & execution)
{
  std::vector<std::vector<SolidPiece>> ofCell(cells);
  execution.For(
    cells,
    [&](std::size_t t) {
      std::vector<SolidPiece> parts = integrator.CutByPlanes(static_cast<IdType>(t));
      const auto              misses = [&](SolidPiece & piece) { return !integrator.CutByCapsule(piece); };
      if (hasCapsule)
      {
        parts.erase(std::remove_if(parts.begin(), parts.end(), misses), parts.end());
      }
      ofCell[t] = std::move(parts);
    },
    64);
  std::vector<SolidPiece> pieces;
  for (const auto & parts : ofCell)
  {
    pieces.insert(pieces.end(), parts.begin(), parts.end());
  }
  return pieces;
}

void
AddPart(const PartDensity & part, PartDensity & sum)
{
  sum.volume += part.volume;
  sum.mass += part.mass;
  sum.volumeError += part.volumeError;
  sum.massError += part.massError;
}

void
FinishPart(bool hasDensity, PartDensity & part)
{
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (!hasDensity)
  {
    part.mass = part.massError = none;
  }
  part.mean = part.volume != 0.0 ? part.mass / part.volume : none;
}
} // namespace

SolidDensity
IntegrateSolid(const MeshArrays & mesh,
               const Solid &      solid,
               double             relativeError,
               const Execution &  execution,
               std::size_t        mostPieces)
{
  if (!(relativeError > 0.0))
  {
    throw std::invalid_argument("The relative error of a solid's integrals must be above 0, but is " +
                                std::to_string(relativeError) + ".");
  }
  const bool                hasDensity = mesh.HasDensity();
  const SolidIntegrator     integrator(mesh, solid);
  const std::vector<double> largest = integrator.LargestDensities();
  std::vector<SolidPiece>   pieces = CutMesh(integrator, mesh.tetrahedra.size(), solid.capsule.has_value(), execution);
  if (solid.capsule)
  {
    RefineSolid(integrator, pieces, relativeError, execution, mostPieces);
  }
  std::vector<PartDensity> parts(pieces.size());
  execution.For(
    pieces.size(),
    [&](std::size_t i) {
      const SolidPiece & piece = pieces[i];
      const int          region = mesh.region.empty() ? 0 : mesh.region[piece.cell];
      parts[i] = { region, piece.volume, 0.0, 0.0, piece.volumeError, 0.0 };
      if (hasDensity)
      {
        parts[i].mass = integrator.Mass(piece);
        parts[i].massError = piece.volumeError * largest[piece.cell];
      }
    },
    64);
  std::map<int, PartDensity> regions;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const int region = mesh.region.empty() ? 0 : mesh.region[t];
    regions[region].region = region;
  }
  SolidDensity result;
  for (const PartDensity & part : parts)
  {
    AddPart(part, result.total);
    AddPart(part, regions[part.region]);
  }
  FinishPart(hasDensity, result.total);
  for (auto & [region, part] : regions)
  {
    FinishPart(hasDensity, part);
    result.regions.push_back(part);
  }
  return result;
}
} // namespace bone
