/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneQualityValidation tile CT LABELS LABEL AXIS MESH.vtu CONTOURS.vtp: the tiled mesh of `bonetk build` before its
// quality stage, and the contours of all slices. boneQualityValidation improve MESH.vtu OUT.vtu BOUND CONTOURS.vtp
// LABELS LABEL: runs the quality stage, prints a "name value" a line; CONTOURS and LABELS may be empty.
// boneQualityValidation methods MESH.vtu: volume and inversions of the three smoothing methods by iterations.
#include "boneLabelCrop.h"
#include "boneMeshImageMetrics.h"
#include "boneContourIO.h"
#include "boneMeshIO.h"
#include "boneMeshValidator.h"
#include "bonePredicates.h"
#include "boneQualityMeasures.h"
#include "boneResolution.h"
#include "boneMeshImprovement.h"
#include "boneTriangleTree.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iostream>
#include <limits>
#include <map>
#include <optional>

namespace
{
using bone::Id4;
using bone::IdType;
using bone::MeshArrays;
using bone::TetraFaces;
using bone::Vector3;

constexpr double Degree = 57.29577951308232;

double
Angle(const MeshArrays & mesh, const Id4 & c)
{
  const auto & p = mesh.points;
  return std::acos(std::min(1.0, bone::LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]))) * Degree;
}

/** Mean smallest dihedral angle (degrees) of the three cells of a prism over an equilateral triangle of side 1. */
double
PrismAngle(double height)
{
  const Vector3 a(0, 0, 0), b(1, 0, 0), c(0.5, std::sqrt(0.75), 0), up(0, 0, height);
  const double  cosines[3] = { bone::LargestDihedralCosine(a, b, c, c + up),
                               bone::LargestDihedralCosine(a, b, b + up, c + up),
                               bone::LargestDihedralCosine(a, a + up, b + up, c + up) };
  double        sum = 0.0;
  for (double cosine : cosines)
  {
    sum += std::acos(cosine) * Degree / 3.0;
  }
  return sum;
}

/** What the thickness of the cortical layer allows at each cell of it: PrismAngle of the length of the chord through
 * the cell's centroid, across the layer from the nearest point of its surfaces, over the mean edge of the cell's faces
 * on them. Thicker than 0.9 edges a prism's angles fall again; a layer is then no longer a row of prisms. */
class CorticalAllowance
{
public:
  explicit CorticalAllowance(const MeshArrays & mesh)
    : m_Mesh(mesh)
    , m_EdgeSum(mesh.points.size(), 0.0)
    , m_EdgeCount(mesh.points.size(), 0)
  {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    {
      for (int i = 0; i < 4; ++i)
      {
        if (mesh.region[t] == bone::Cortical && Leaves(mesh.neighbors[t][i]))
        {
          const Id4 &                        c = mesh.tetrahedra[t];
          const std::array<IdType, 3>        f{ { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] } };
          const bone::TriangleTree::Triangle triangle{ { mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]] } };
          m_Triangles.push_back(triangle);
          for (int k = 0; k < 3; ++k)
          {
            m_EdgeSum[f[k]] += (triangle[(k + 1) % 3] - triangle[k]).norm();
            ++m_EdgeCount[f[k]];
          }
        }
      }
    }
    m_Tree = bone::TriangleTree(m_Triangles);
  }

  double
  At(IdType t) const
  {
    const Id4 & c = m_Mesh.tetrahedra[t];
    Vector3     centroid = Vector3::Zero();
    double      edge = 0.0;
    int         edges = 0;
    for (IdType p : c)
    {
      centroid += m_Mesh.points[p] / 4.0;
      if (m_EdgeCount[p] > 0)
      {
        edge += m_EdgeSum[p] / m_EdgeCount[p];
        ++edges;
      }
    }
    if (edges == 0)
    {
      return PrismAngle(0.9);
    }
    const Vector3 foot = m_Tree.FindNearest(centroid).point;
    const double  depth = (centroid - foot).norm();
    const double  thickness = depth + Walk(t, centroid, (centroid - foot) / depth);
    return PrismAngle(std::min(0.9, thickness * edges / edge));
  }

private:
  bool
  Leaves(IdType neighbor) const
  {
    return neighbor < 0 || m_Mesh.region[neighbor] != bone::Cortical;
  }

  /** Length of the ray from a point in cell t until it leaves the layer. */
  double
  Walk(IdType t, const Vector3 & origin, const Vector3 & direction) const
  {
    double length = 0.0;
    for (int steps = 0; steps < 1000; ++steps)
    {
      const Id4 & c = m_Mesh.tetrahedra[t];
      double      exit = 1e300;
      int         side = 0;
      for (int i = 0; i < 4; ++i)
      {
        const Vector3 & a = m_Mesh.points[c[TetraFaces[i][0]]];
        const Vector3   normal = (m_Mesh.points[c[TetraFaces[i][1]]] - a).cross(m_Mesh.points[c[TetraFaces[i][2]]] - a);
        const double    along = normal.dot(direction);
        const double    s = along > 0 ? normal.dot(a - origin) / along : 1e300;
        if (s < exit)
        {
          exit = s;
          side = i;
        }
      }
      length = std::max(length, exit);
      const IdType next = m_Mesh.neighbors[t][side];
      if (Leaves(next))
      {
        break;
      }
      t = next;
    }
    return length;
  }

  const MeshArrays &                        m_Mesh;
  std::vector<double>                       m_EdgeSum;
  std::vector<int>                          m_EdgeCount;
  std::vector<bone::TriangleTree::Triangle> m_Triangles;
  bone::TriangleTree                        m_Tree;
};

struct Roughness
{
  double all{ 0.0 };    ///< mean angle between neighbouring boundary triangles, degrees
  double across{ 0.0 }; ///< the same over edges within a slice, where slice meets slice
};

Roughness
MeasureRoughness(const MeshArrays & mesh)
{
  // Rims and insides of flat cuts are no roughness.
  const bone::SurfaceComplex                   surfaces = bone::FindSurfaces(mesh);
  std::map<std::pair<IdType, IdType>, Vector3> open;
  Roughness                                    sum;
  std::size_t                                  all = 0, across = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      if (mesh.neighbors[t][i] >= 0 || surfaces.surfaces[surfaces.faceSurface[t][i]].flat >= 0)
      {
        continue;
      }
      const Id4 &   c = mesh.tetrahedra[t];
      const IdType  f[3] = { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] };
      const Vector3 normal =
        (mesh.points[f[1]] - mesh.points[f[0]]).cross(mesh.points[f[2]] - mesh.points[f[0]]).normalized();
      for (int k = 0; k < 3; ++k)
      {
        const auto edge = std::minmax(f[k], f[(k + 1) % 3]);
        const auto found = open.emplace(edge, normal);
        if (found.second)
        {
          continue;
        }
        const double turn = std::acos(std::clamp(found.first->second.dot(normal), -1.0, 1.0)) * Degree;
        sum.all += turn;
        ++all;
        if (!mesh.slice.empty() && mesh.slice[edge.first] == mesh.slice[edge.second])
        {
          sum.across += turn;
          ++across;
        }
      }
    }
  }
  return { sum.all / static_cast<double>(all), sum.across / static_cast<double>(across) };
}

std::map<int, double>
RegionVolumes(const MeshArrays & mesh)
{
  std::map<int, double> volumes;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const auto & p = mesh.points;
    const Id4 &  c = mesh.tetrahedra[t];
    volumes[mesh.region[t]] += bone::SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
  }
  return volumes;
}

void
PrintQuality(const std::string & when, const MeshArrays & mesh)
{
  const CorticalAllowance allowance(mesh);
  struct Tally
  {
    double count{ 0 }, least{ 180 }, below2{ 0 }, below5{ 0 }, below8{ 0 }, sum{ 0 }, allowed{ 0 };
  };
  std::map<int, Tally> tallies;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const double angle = Angle(mesh, mesh.tetrahedra[t]);
    const int    region = mesh.region[t];
    Tally &      tally = tallies[region];
    ++tally.count;
    tally.least = std::min(tally.least, angle);
    tally.below2 += angle < 2;
    tally.below5 += angle < 5;
    tally.below8 += angle < 8;
    tally.sum += angle;
    tally.allowed += region == bone::Cortical ? allowance.At(static_cast<IdType>(t)) : 0.0;
  }
  for (const auto & [region, tally] : tallies)
  {
    const std::string name = when + ".region" + std::to_string(region) + '.';
    std::cout << name << "cells " << tally.count << '\n'
              << name << "least " << tally.least << '\n'
              << name << "below2 " << tally.below2 << '\n'
              << name << "below5 " << tally.below5 << '\n'
              << name << "below8 " << tally.below8 << '\n'
              << name << "mean " << tally.sum / tally.count << '\n';
    if (region == bone::Cortical)
    {
      std::cout << name << "allowed " << tally.allowed / tally.count << '\n';
    }
  }
  double total = 0.0;
  for (const auto & [region, volume] : RegionVolumes(mesh))
  {
    std::cout << when << ".region" << region << ".volume " << volume << '\n';
    total += volume;
  }
  const Roughness            roughness = MeasureRoughness(mesh);
  const bone::MeshValidation validation = bone::ValidateMesh(mesh);
  std::cout << when << ".points " << mesh.points.size() << '\n'
            << when << ".cells " << mesh.tetrahedra.size() << '\n'
            << when << ".volume " << total << '\n'
            << when << ".roughness " << roughness.all << '\n'
            << when << ".roughness_across " << roughness.across << '\n'
            << when << ".valid " << validation.IsValid() << '\n';
  if (!validation.IsValid())
  {
    std::cerr << when << ": " << validation.Summary() << '\n';
  }
}

std::vector<bone::TriangleTree::Triangle>
Surface(const MeshArrays & mesh, int minimumRegion)
{
  std::vector<bone::TriangleTree::Triangle> triangles;
  for (const auto & f : bone::BoundaryFaces(mesh, minimumRegion))
  {
    triangles.push_back({ { mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]] } });
  }
  return triangles;
}

/** Distance of one surface's triangles from another surface: mean by area and largest, at vertices, edge midpoints and
 * centroids. */
std::array<double, 2>
Distance(const std::vector<bone::TriangleTree::Triangle> & from, const bone::TriangleTree & to)
{
  double sum = 0.0, area = 0.0, largest = 0.0;
  for (const auto & t : from)
  {
    const Vector3 samples[7] = {
      t[0], t[1], t[2], 0.5 * (t[0] + t[1]), 0.5 * (t[1] + t[2]), 0.5 * (t[2] + t[0]), (t[0] + t[1] + t[2]) / 3.0
    };
    const double weight = (t[1] - t[0]).cross(t[2] - t[0]).norm();
    for (const Vector3 & x : samples)
    {
      const double distance = std::sqrt(to.FindNearest(x).squaredDistance);
      sum += weight * distance / 7.0;
      largest = std::max(largest, distance);
    }
    area += weight;
  }
  return { sum / area, largest };
}

void
PrintDistances(const std::string & name, std::vector<double> distances)
{
  if (distances.empty())
  {
    return;
  }
  double sum = 0.0;
  for (const double distance : distances)
  {
    sum += distance;
  }
  std::sort(distances.begin(), distances.end());
  const auto last = static_cast<double>(distances.size() - 1);
  std::cout << name << ".mean " << sum / (last + 1.0) << '\n'
            << name << ".percentile95 " << distances[static_cast<std::size_t>(0.95 * last)] << '\n'
            << name << ".largest " << distances.back() << '\n';
}

/** Distances between each surface (the boundary and the interfaces between regions) and the contours it was made of:
 * from points on the contours to the surface, and from the surface's corners and centroids to the shape of the
 * contours, where that is known and its normal lies within 45 degrees of the slices. Between slices the distance is
 * that of the interpolated shape, to first order. */
void
PrintContourDistances(const std::string & when, const MeshArrays & mesh, const bone::ContourShape & shape)
{
  constexpr double spacing = 0.5; // mm, of points on the contours
  for (int level = 1; level <= shape.GetLevels(); ++level)
  {
    const auto          surface = Surface(mesh, level);
    const std::string   name = when + ".level" + std::to_string(level);
    std::vector<double> forth, back;
    if (surface.empty())
    {
      continue;
    }
    const bone::TriangleTree tree(surface);
    for (const auto & sample : shape.SampleContours(level, spacing))
    {
      forth.push_back(std::sqrt(tree.FindNearest(sample.place).squaredDistance));
    }
    for (const auto & t : surface)
    {
      const Vector3 samples[4] = { t[0], t[1], t[2], (t[0] + t[1] + t[2]) / 3.0 };
      for (const Vector3 & x : samples)
      {
        const auto value = shape.Evaluate(level, x);
        if (value && std::abs(value->gradient.normalized().dot(shape.GetNormal())) < M_SQRT1_2)
        {
          back.push_back(std::abs(value->distance) / value->gradient.norm());
        }
      }
    }
    PrintDistances(name + ".from_contours", forth);
    PrintDistances(name + ".to_contours", back);
  }
}

/** Overlap and distances with a label map. */
void
PrintAgreement(const std::string & when, const MeshArrays & mesh, const bone::LabelImage * mask)
{
  MeshArrays solid = mesh;
  solid.degree.assign(mesh.tetrahedra.size(), 0);
  solid.coefficients.assign(mesh.tetrahedra.size(), 1.0);
  solid.maximumDegree = 0;
  const bone::SurfaceDistances distances = bone::SurfaceDistanceMeter(mask).Measure(mesh);
  std::cout << when << ".dice " << bone::DiceOverlap(solid, mask) << '\n'
            << when << ".to_label " << distances.meshToMask.mean << '\n'
            << when << ".to_label95 " << distances.meshToMask.percentile95 << '\n'
            << when << ".from_label " << distances.maskToMesh.mean << '\n'
            << when << ".from_label95 " << distances.maskToMesh.percentile95 << '\n';
}

int
Improve(const std::string & input,
        const std::string & output,
        double              bound,
        const std::string & contours,
        const std::string & labels,
        int                 label)
{
  const MeshArrays before = bone::ReadMeshArrays(input);
  PrintQuality("before", before);
  bone::LabelImage::Pointer mask;
  if (!labels.empty())
  {
    const auto map = bone::ReadLabels(labels);
    const auto extent = bone::MeasureLabel(map, label);
    mask = bone::MaskOfLabel(bone::Crop(map, bone::GrowRegion(bone::ReadCT(labels), extent.region, 10.0)), label);
    PrintAgreement("before", before, mask);
  }
  bone::TetraComplex          complex(before);
  bone::ImprovementParameters parameters;
  parameters.distanceBound = bound;
  parameters.slices = before.slice;
  bone::LabelOutline outline;
  if (mask.IsNotNull())
  {
    outline = bone::FindOutline(*mask, 0);
    parameters.outline = &outline;
  }
  std::optional<bone::ContourShape> shape;
  if (!contours.empty())
  {
    shape.emplace(*bone::ReadContours(contours));
    parameters.shape = &*shape;
    PrintContourDistances("before", before, *shape);
  }
  const auto          start = std::chrono::steady_clock::now();
  const std::clock_t  clock = std::clock();
  const auto          report = bone::ImproveMesh(complex, parameters);
  std::vector<IdType> pointId, cellSlot;
  const MeshArrays    after = complex.Compact(before, pointId, cellSlot);
  std::cout << "seconds " << std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()
            << "\ncpu_seconds " << static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC << "\nflips "
            << report.flips << "\noptimized " << report.optimized << "\nrepairs " << report.repairs << "\nsplits "
            << report.splits << "\ncollapses " << report.collapses << '\n';
  bone::WriteMeshArrays(after, output);
  PrintQuality("after", after);
  if (shape)
  {
    PrintContourDistances("after", after, *shape);
  }
  if (mask.IsNotNull())
  {
    PrintAgreement("after", after, mask);
  }
  double displacement = 0.0;
  int    moved = 0;
  for (std::size_t p = 0; p < pointId.size(); ++p)
  {
    if (pointId[p] < static_cast<IdType>(before.points.size()) && complex.Dimension(pointId[p]) < 3)
    {
      displacement += (after.points[p] - before.points[pointId[p]]).norm();
      ++moved;
    }
  }
  std::cout << "displacement " << displacement / moved << '\n';
  for (const auto & [region, volume] : RegionVolumes(before))
  {
    const auto first = Surface(before, region), second = Surface(after, region);
    const auto forth = Distance(second, bone::TriangleTree(first));
    const auto back = Distance(first, bone::TriangleTree(second));
    const auto name = "surface" + std::to_string(region) + '.';
    std::cout << name << "mean " << forth[0] << '\n'
              << name << "largest " << forth[1] << '\n'
              << name << "mean_back " << back[0] << '\n'
              << name << "largest_back " << back[1] << '\n';
  }
  return 0;
}

int
Methods(const std::string & input)
{
  const MeshArrays before = bone::ReadMeshArrays(input);
  const auto       total = [](const MeshArrays & mesh) {
    double sum = 0.0;
    for (const auto & entry : RegionVolumes(mesh))
    {
      sum += entry.second;
    }
    return sum;
  };
  const std::pair<std::string, bone::SmoothingMethod> methods[] = { { "laplacian", bone::SmoothingMethod::Laplacian },
                                                                    { "smart", bone::SmoothingMethod::Smart },
                                                                    { "enhanced", bone::SmoothingMethod::Enhanced } };
  for (const auto & [name, method] : methods)
  {
    for (int iterations : { 1, 2, 5, 10, 20, 50 })
    {
      bone::TetraComplex             complex(before);
      bone::TetraSmoothingParameters parameters;
      parameters.method = method;
      parameters.iterations = iterations;
      bone::SmoothPoints(complex, parameters);
      std::vector<IdType> pointId, cellSlot;
      const MeshArrays    after = complex.Compact(before, pointId, cellSlot);
      std::cout << name << ' ' << iterations << ' ' << 100.0 * (total(after) / total(before) - 1.0) << ' '
                << bone::CountInverted(after) << '\n';
    }
  }
  return 0;
}

/** As `bonetk build` does it. */
int
Tile(const std::string & ct,
     const std::string & labels,
     int                 label,
     const std::string & axis,
     const std::string & output,
     const std::string & contours)
{
  auto                image = bone::ReadCT(ct);
  auto                map = bone::ReadLabels(labels);
  const auto          extent = bone::MeasureLabel(map, label);
  const auto          region = bone::GrowRegion(image, extent.region, 10.0);
  bone::BuildPipeline pipeline(1);
  image = bone::Crop(image, region);
  pipeline.SetImage(image);
  pipeline.SetLabelImage(bone::Crop(map, region));
  pipeline.GetSnake()->SetLabel(label);
  const unsigned int along = axis == "x" ? 0 : axis == "y" ? 1 : 2;
  pipeline.GetSnake()->SetAxis(along);
  constexpr IdType tetrahedra = 33000;
  const double     spacing = image->GetSpacing()[along];
  bone::AdjustResolution(pipeline,
                         bone::EstimateResolution(extent.surface, spacing, tetrahedra),
                         { tetrahedra, spacing, false },
                         [](const bone::Resolution &, IdType) {});
  bone::WriteMeshArrays(pipeline.GetTiling()->GetOutput()->GetArrays(), output);
  bone::WriteContours(pipeline.GetSnake()->GetOutput(), contours);
  return 0;
}
} // namespace

int
main(int argc, char * argv[])
{
  const std::string command = argc > 1 ? argv[1] : "";
  try
  {
    if (command == "tile" && argc == 8)
    {
      return Tile(argv[2], argv[3], std::stoi(argv[4]), argv[5], argv[6], argv[7]);
    }
    if (command == "improve" && argc == 8)
    {
      return Improve(argv[2], argv[3], std::stod(argv[4]), argv[5], argv[6], std::stoi(argv[7]));
    }
    if (command == "methods" && argc == 3)
    {
      return Methods(argv[2]);
    }
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
  std::cerr << "usage: boneQualityValidation tile CT LABELS LABEL AXIS MESH.vtu CONTOURS.vtp\n"
               "       boneQualityValidation improve MESH.vtu OUT.vtu BOUND CONTOURS.vtp LABELS LABEL\n"
               "       boneQualityValidation methods MESH.vtu\n";
  return 2;
}
