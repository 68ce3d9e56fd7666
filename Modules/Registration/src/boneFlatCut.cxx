/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFlatCut.h"

#include "boneBernstein.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace bone
{
namespace
{
/** A face of the exterior. */
struct ExteriorFace
{
  std::array<Vector3, 3> corners;
  Vector3                normal; ///< outward, of length 1 (0 where the face has no area)
  double                 area;   ///< mm^2

  bool
  LiesOn(const FlatCut & cut) const
  {
    constexpr double flat = 0.05; // mm
    return normal.dot(cut.inward) < -0.999 && std::all_of(corners.begin(), corners.end(), [&cut](const Vector3 & x) {
             return std::abs(cut.inward.dot(x) - cut.offset) < flat;
           });
  }
};

std::vector<ExteriorFace>
ExteriorFaces(const MeshArrays & mesh)
{
  std::vector<ExteriorFace> faces;
  for (const auto & face : BoundaryFaces(mesh))
  {
    ExteriorFace exterior;
    std::transform(face.begin(), face.end(), exterior.corners.begin(), [&mesh](IdType p) {
      return mesh.points[static_cast<std::size_t>(p)];
    });
    exterior.normal = (exterior.corners[1] - exterior.corners[0]).cross(exterior.corners[2] - exterior.corners[0]);
    exterior.area = 0.5 * exterior.normal.norm();
    exterior.normal.normalize();
    faces.push_back(exterior);
  }
  return faces;
}

/** The planes of the faces, one of each group that is about the same, where the group has some area. */
std::vector<FlatCut>
LikelyPlanes(const std::vector<ExteriorFace> & faces)
{
  constexpr double                                          least = 10.0; // mm^2
  std::map<std::array<long, 4>, std::pair<FlatCut, double>> groups;
  for (const ExteriorFace & face : faces)
  {
    if (face.area > 0.0)
    {
      const Vector3 inward = -face.normal;
      const double  offset = inward.dot(face.corners[0]);
      auto &        group = groups[{ { std::lround(20.0 * inward.x()),
                                       std::lround(20.0 * inward.y()),
                                       std::lround(20.0 * inward.z()),
                                       std::lround(offset) } }];
      group.first = { inward, offset };
      group.second += face.area;
    }
  }
  std::vector<FlatCut> planes;
  for (const auto & group : groups)
  {
    if (group.second.second > least)
    {
      planes.push_back(group.second.first);
    }
  }
  return planes;
}

/** Centroids and volumes of a mesh's cells. */
class CellWeights
{
public:
  explicit CellWeights(const MeshArrays & mesh)
    : m_Centroids(3, static_cast<Eigen::Index>(mesh.tetrahedra.size()))
    , m_Volumes(m_Centroids.cols())
  {
    for (Eigen::Index t = 0; t < m_Volumes.size(); ++t)
    {
      std::array<Vector3, 4> x;
      const Id4 &            cell = mesh.tetrahedra[static_cast<std::size_t>(t)];
      std::transform(
        cell.begin(), cell.end(), x.begin(), [&mesh](IdType p) { return mesh.points[static_cast<std::size_t>(p)]; });
      m_Centroids.col(t) = (x[0] + x[1] + x[2] + x[3]) / 4.0;
      m_Volumes[t] = std::abs(SignedVolume(x[0], x[1], x[2], x[3]));
    }
  }

  /** Whether the mean section parallel to the cut in the slab beneath it is smaller than this, mm^2. */
  bool
  IsSectionBeneathBelow(const FlatCut & cut, double area) const
  {
    constexpr double       slab = 10.0;  // mm
    constexpr Eigen::Index block = 2048; // cells after which a section may be large enough to look no further
    double                 volume = 0.0;
    for (Eigen::Index t = 0; t < m_Volumes.size() && volume < area * slab; t += block)
    {
      const Eigen::Index   n = std::min(block, m_Volumes.size() - t);
      const Eigen::ArrayXd depth =
        (cut.inward.transpose() * m_Centroids.middleCols(t, n)).transpose().array() - cut.offset;
      volume += (depth > 0.0 && depth < slab).select(m_Volumes.segment(t, n), 0.0).sum();
    }
    return volume < area * slab;
  }

private:
  Eigen::Matrix3Xd m_Centroids;
  Eigen::ArrayXd   m_Volumes;
};
} // namespace

std::vector<FlatCut>
FindFlatCuts(const MeshArrays & mesh)
{
  const std::vector<ExteriorFace> faces = ExteriorFaces(mesh);
  const CellWeights               cells(mesh);
  std::vector<FlatCut>            cuts;
  for (const FlatCut & plane : LikelyPlanes(faces))
  {
    const bool isKnown = std::any_of(cuts.begin(), cuts.end(), [&plane](const FlatCut & cut) {
      return cut.inward.dot(plane.inward) > 0.999 && std::abs(cut.offset - plane.offset) < 1.0;
    });
    if (isKnown)
    {
      continue;
    }
    double area = 0.0;
    for (const ExteriorFace & face : faces)
    {
      area += face.LiesOn(plane) ? face.area : 0.0;
    }
    if (cells.IsSectionBeneathBelow(plane, 2.0 * area))
    {
      cuts.push_back(plane);
    }
  }
  return cuts;
}

void
FadeToCuts(MeshArrays & mesh, const std::vector<FlatCut> & cuts, double length)
{
  const auto row = static_cast<std::size_t>(BernsteinCount(std::max(0, mesh.maximumDegree)));
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const auto & exponents = BernsteinExponents(mesh.degree[t]);
    for (std::size_t c = 0; c < exponents.size(); ++c)
    {
      Vector3 x = Vector3::Zero(); // the control point's place
      for (std::size_t v = 0; v < 4; ++v)
      {
        const double share = mesh.degree[t] > 0 ? static_cast<double>(exponents[c][v]) / mesh.degree[t] : 0.25;
        x += share * mesh.points[static_cast<std::size_t>(mesh.tetrahedra[t][v])];
      }
      for (const FlatCut & cut : cuts)
      {
        mesh.coefficients[t * row + c] *= std::clamp((cut.inward.dot(x) - cut.offset) / length, 0.0, 1.0);
      }
    }
  }
}

std::vector<MeshArrays>
FadeFlatCuts(std::vector<MeshArrays> levels, double length)
{
  const std::vector<FlatCut> cuts = FindFlatCuts(levels.front());
  for (MeshArrays & level : levels)
  {
    if (!cuts.empty() && length > 0.0)
    {
      FadeToCuts(level, cuts, length);
    }
  }
  return levels;
}
} // namespace bone
