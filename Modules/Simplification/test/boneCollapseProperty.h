/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCollapseProperty_h
#define boneCollapseProperty_h

#include "../../Core/test/boneTestBodies.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneSurfaceGrid.h"
#include "boneTetraCollapseFilter.h"
#include "boneTetraLocator.h"
#include "boneTriangleTree.h"

#include <random>
#include <set>
#include <sstream>

namespace bone::test
{
/** A random layered body without density: a rod, a ring or a ball. */
inline MeshArrays
RandomBody(unsigned seed)
{
  TubeShape shape;
  shape.seed = seed;
  shape.bumps = 0.1 * (seed % 5);
  shape.closed = seed % 3 == 0;
  shape.slices = shape.closed ? 18 + seed % 7 : 5 + seed % 7;
  shape.around = 7 + seed % 5;
  shape.spacing = shape.closed ? 7 : 2;
  shape.rings = seed % 2 == 0 ? std::vector<int>{ 1, 1, 2 } : std::vector<int>{ 2, 1 };
  return seed % 4 == 1 ? MakeBall(3, { 1, 1, 1 }, 14, 0.15, seed) : MakeTube(shape);
}

/** \brief Simplifies a mesh under random bounds and looks whether every level keeps to them; all is measured here, by
 * other means than the filter's. Says what was wrong, nothing where all was right. */
class CollapseProperty
{
public:
  CollapseProperty(MeshArrays mesh, unsigned seed)
    : m_Mesh(std::move(mesh))
    , m_Random(seed)
  {
    const double a = Uniform(4, 15), b = Uniform(4, 15), c = Uniform(100, 400);
    SetDensity(m_Mesh, static_cast<int>(Uniform(0, 4)), [=](const Vector3 & x) {
      return 500 + c * std::sin(x.x() / a) * std::cos(x.y() / b) * std::sin(x.z() / a);
    });
    const auto n = static_cast<double>(m_Mesh.tetrahedra.size());
    m_Filter->SetInput(AsMesh());
    if (Uniform(0, 1) < 0.6)
    {
      m_Counts = { static_cast<IdType>(n * Uniform(0.3, 1.1)), static_cast<IdType>(n * Uniform(0.02, 0.3)) };
    }
    const double first = Uniform(0.5, 20), second = first * Uniform(1, 4);
    if (m_Counts.empty() || Uniform(0, 1) < 0.5)
    {
      m_Errors = { first, second };
    }
    if (Uniform(0, 1) < 0.6)
    {
      const double distance = std::exp(Uniform(-3.5, 1));
      m_Distances = { distance, distance * Uniform(1, 3) };
    }
    m_Volume = Uniform(0, 1) < 0.7 ? std::exp(Uniform(-7, -2)) : std::numeric_limits<double>::infinity();
    m_Angle = Uniform(0, 0.25);
    m_CorticalAngle = Uniform(0, 1) * m_Angle;
    m_Filter->SetLevels(m_Counts);
    m_Filter->SetMaximumDensityErrors(m_Errors);
    m_Filter->SetMaximumSurfaceDistances(m_Distances);
    m_Filter->SetMaximumVolumeChange(m_Volume);
    m_Filter->SetMinimumDihedralAngle(m_Angle);
    m_Filter->SetMinimumCorticalDihedralAngle(m_CorticalAngle);
    m_Filter->SetMaximumDegree(Uniform(0, 1) < 0.3 ? m_Mesh.maximumDegree + 2 : -1);
    m_Improves = m_Distances.empty() && Uniform(0, 1) < 0.5;
    m_Filter->SetImproveAngles(m_Improves);
  }

  std::string
  Check()
  {
    m_Filter->Update();
    const auto & levels = m_Filter->GetOutput()->GetLevels();
    for (std::size_t i = 1; i < levels.size(); ++i)
    {
      m_Prefix = "level " + std::to_string(i + 1) + ": ";
      const MeshArrays level = levels[i].mesh->GetArrays();
      const auto       validation = ValidateMesh(level);
      Require(validation.IsValid(), validation.Summary());
      Require(level.neighbors == ComputeFaceNeighbors(level.tetrahedra), "neighbours");
      CheckPoints(levels[i - 1].mesh->GetArrays(), level, levels[i].parentPoint);
      CheckSurfaces(level, i - 1 < m_Distances.size() ? m_Distances[i - 1] : m_Infinity, levels[i].surfaceError);
      CheckAngles(level);
      CheckDensity(level, i - 1 < m_Errors.size() ? m_Errors[i - 1] : m_Infinity, levels[i].densityError);
      CheckStop(levels[i], levels[i - 1].mesh->GetNumberOfTetrahedra(), i);
    }
    return m_Failures.str();
  }

  /** Independent over stated density error of the last level, where there is one. */
  double
  DensityRatio() const
  {
    return m_DensityRatio;
  }

private:
  using MeshType = DensityMesh<double>;
  using FilterType = TetraCollapseFilter<MeshType>;
  using Faces = std::vector<std::array<IdType, 3>>;

  double
  Uniform(double low, double high)
  {
    return low + (high - low) * static_cast<double>(m_Random()) / 4294967296.0;
  }

  MeshType::Pointer
  AsMesh() const
  {
    auto mesh = MeshType::New();
    mesh->SetArrays(m_Mesh);
    return mesh;
  }

  void
  Require(bool right, const std::string & what)
  {
    if (!right)
    {
      m_Failures << m_Prefix << what << "; ";
    }
  }

  void
  CheckPoints(const MeshArrays & before, const MeshArrays & level, const std::vector<IdType> & parent)
  {
    bool right =
      parent.size() == level.points.size() && std::set<IdType>(parent.begin(), parent.end()).size() == parent.size();
    for (std::size_t p = 0; right && p < parent.size(); ++p)
    {
      right = (m_Improves || level.points[p] == before.points[parent[p]]) && level.layer[p] == before.layer[parent[p]];
    }
    Require(right, "points are no subset");
  }

  /** Largest distance of random points on faces of a mesh to those of the other. */
  double
  Distance(const MeshArrays & from, const Faces & fromFaces, const MeshArrays & to, const Faces & toFaces)
  {
    std::vector<TriangleTree::Triangle> triangles;
    for (const auto & f : toFaces)
    {
      triangles.push_back({ to.points[f[0]], to.points[f[1]], to.points[f[2]] });
    }
    const TriangleTree tree(triangles);
    double             largest = 0.0;
    for (const auto & f : fromFaces)
    {
      for (int k = 0; k < 5; ++k)
      {
        double u = Uniform(0, 1), v = Uniform(0, 1);
        if (u + v > 1)
        {
          u = 1 - u;
          v = 1 - v;
        }
        const Vector3 &a = from.points[f[0]], &b = from.points[f[1]], &c = from.points[f[2]];
        largest = std::max(largest, tree.FindNearest(a + u * (b - a) + v * (c - a)).squaredDistance);
      }
    }
    return std::sqrt(largest);
  }

  void
  CheckSurfaces(const MeshArrays & level, double bound, double stated)
  {
    const std::set<int> regions(m_Mesh.region.begin(), m_Mesh.region.end());
    for (int region : regions)
    {
      const Faces  before = BoundaryFaces(m_Mesh, region), now = BoundaryFaces(level, region);
      const double largest = std::max(Distance(level, now, m_Mesh, before), Distance(m_Mesh, before, level, now));
      const double change = std::abs(test::RegionVolume(level, region) / test::RegionVolume(m_Mesh, region) - 1.0);
      const auto   name = " of region " + std::to_string(region);
      Require(FindCrossingTriangles(now, level.points).empty(), "crossing triangles" + name);
      Require(largest <= bound * (1 + 1e-9) + 1e-9, "distance " + std::to_string(largest) + name);
      Require(largest <= stated + 0.011, "distance stated " + std::to_string(stated) + name);
      Require(change <= m_Volume * (1 + 1e-9) + 1e-12, "volume " + std::to_string(change) + name);
    }
    Require(stated <= bound * (1 + 1e-9) + 1e-9, "stated distance " + std::to_string(stated));
  }

  static double
  Angle(const MeshArrays & mesh, bool cortical)
  {
    double worst = 1.0 / 3.0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    {
      const Id4 & v = mesh.tetrahedra[t];
      if ((mesh.region[t] == Cortical) == cortical)
      {
        const auto & p = mesh.points;
        worst = std::max(worst, LargestDihedralCosine(p[v[0]], p[v[1]], p[v[2]], p[v[3]]));
      }
    }
    return std::acos(std::min(1.0, worst));
  }

  void
  CheckAngles(const MeshArrays & level)
  {
    Require(Angle(level, true) >= std::min(m_CorticalAngle, Angle(m_Mesh, true)) - 1e-7, "cortical angle");
    Require(Angle(level, false) >= std::min(m_Angle, Angle(m_Mesh, false)) - 1e-7, "angle");
  }

  /** Difference to the finest level at 30 random points of each of its cells. */
  void
  CheckDensity(const MeshArrays & level, double bound, double stated)
  {
    const TetraLocator locator(level);
    const std::size_t  row = BernsteinCount(level.maximumDegree), rowFirst = BernsteinCount(m_Mesh.maximumDegree);
    double             square = 0.0, weight = 0.0;
    for (std::size_t t = 0; t < m_Mesh.tetrahedra.size(); ++t)
    {
      const Id4 &  v = m_Mesh.tetrahedra[t];
      const auto & p = m_Mesh.points;
      const double volume = SignedVolume(p[v[0]], p[v[1]], p[v[2]], p[v[3]]);
      for (int k = 0; k < 30; ++k)
      {
        Barycentric mu(-std::log(Uniform(1e-9, 1)), -std::log(Uniform(1e-9, 1)), -std::log(Uniform(1e-9, 1)), 0);
        mu[3] = -std::log(Uniform(1e-9, 1));
        mu /= mu.sum();
        const Vector3 x = mu[0] * p[v[0]] + mu[1] * p[v[1]] + mu[2] * p[v[2]] + mu[3] * p[v[3]];
        const auto    place = locator.FindNearest(x);
        const double  error = BernsteinValue(m_Mesh.maximumDegree, &m_Mesh.coefficients[rowFirst * t], mu) -
                             BernsteinValue(level.degree[place.cell], &level.coefficients[row * place.cell], place.mu);
        square += volume / 30 * error * error;
        weight += volume / 30;
      }
    }
    const double error = std::sqrt(square / weight);
    m_DensityRatio = stated > 0 ? error / stated : 1.0;
    Require(stated <= bound * (1 + 1e-9), "density error stated " + std::to_string(stated));
    // Both are integrals by points.
    Require(error <= 1.03 * bound, "density error " + std::to_string(error) + ", stated " + std::to_string(stated));
  }

  void
  CheckStop(const DensityHierarchy<MeshType>::Level & level, IdType before, std::size_t i)
  {
    const IdType        n = level.mesh->GetNumberOfTetrahedra();
    const IdType        asked = i - 1 < m_Counts.size() ? m_Counts[i - 1] : 0;
    const std::string & reason = level.stopReason;
    Require((n <= asked) == (reason == "tetrahedra reached"), "stopped with " + std::to_string(n) + " by " + reason);
    // A collapse takes away as many cells as stand around its edge.
    Require(n > asked || n >= std::min(before, asked) - 30, "too few cells: " + std::to_string(n));
    Require(reason != "density error bound" || !m_Errors.empty(), reason);
    Require(reason != "surface distance bound" || !m_Distances.empty(), reason);
    Require(reason != "volume bound" || m_Volume < m_Infinity, reason);
  }

  static constexpr double m_Infinity = std::numeric_limits<double>::infinity();

  MeshArrays          m_Mesh;
  std::mt19937        m_Random;
  FilterType::Pointer m_Filter{ FilterType::New() };
  std::vector<IdType> m_Counts;
  std::vector<double> m_Errors;
  std::vector<double> m_Distances;
  double              m_Volume;
  double              m_Angle;
  double              m_CorticalAngle;
  bool                m_Improves; ///< angles: points move
  double              m_DensityRatio{ 1.0 };
  std::string         m_Prefix;
  std::ostringstream  m_Failures;
};
} // namespace bone::test

#endif
