/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneSimplificationValidation levels L1.vtu PREFIX CT LABELS LABEL COUNT...: a hierarchy of a mesh, audited level by
// level, its density compared with the CT at the label's voxels (label 0: all that are not 0); JSON.
// boneSimplificationValidation compare MESH.vtu CT LABELS LABEL: its density against the CT.
// boneSimplificationValidation property FIRST LAST: random meshes and bounds by seed; says what was wrong.
// boneSimplificationValidation time L1.vtu REPEAT COUNT...: seconds of the simplification alone, the least of REPEAT.
#include "boneImageIO.h"

#include "boneCollapseProperty.h"
#include "boneContourTiler.h"
#include "boneDensityEvaluation.h"
#include "boneHierarchyIO.h"
#include "boneMeshIO.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneRandomStack.h"
#include "boneSurfaceAudit.h"
#include "boneSurfaceGrid.h"
#include "boneTetraCollapseFilter.h"
#include "boneTriangleTree.h"
#include "boneVoxelGrid.h"

#include <itkMultiThreaderBase.h>

#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <ctime>
#include <iostream>
#include <set>

namespace
{
using namespace bone;
using nlohmann::json;
using MeshType = DensityMesh<double>;
using FilterType = TetraCollapseFilter<MeshType>;
using Faces = std::vector<std::array<IdType, 3>>;

constexpr double Degree = 57.29577951308232;

FilterType::Pointer
MakeFilter(const MeshType * mesh, const std::vector<IdType> & counts, unsigned threads, bool improveAngles = false)
{
  auto filter = FilterType::New();
  filter->SetImproveAngles(improveAngles);
  filter->SetInput(mesh);
  filter->SetLevels(counts);
  filter->SetNumberOfWorkUnits(threads);
  filter->GetMultiThreader()->SetMaximumNumberOfThreads(threads);
  return filter;
}

/** Seconds of wall clock and of all processors. */
std::pair<double, double>
TimeOf(FilterType * filter)
{
  const auto         start = std::chrono::steady_clock::now();
  const std::clock_t clock = std::clock();
  filter->Update();
  return { std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
           static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC };
}

template <typename T>
bool
SameBytes(const std::vector<T> & a, const std::vector<T> & b)
{
  return a.size() == b.size() && std::equal(reinterpret_cast<const char *>(a.data()),
                                            reinterpret_cast<const char *>(a.data() + a.size()),
                                            reinterpret_cast<const char *>(b.data()));
}

bool
IsSame(const FilterType * one, const FilterType * other)
{
  bool same = true;
  for (std::size_t i = 0; i < one->GetOutput()->GetNumberOfLevels(); ++i)
  {
    const auto a = one->GetOutput()->GetMesh(i)->GetArrays(), b = other->GetOutput()->GetMesh(i)->GetArrays();
    same = same && SameBytes(a.points, b.points) && SameBytes(a.tetrahedra, b.tetrahedra) &&
           SameBytes(a.neighbors, b.neighbors) && SameBytes(a.region, b.region) && SameBytes(a.layer, b.layer) &&
           SameBytes(a.degree, b.degree) && SameBytes(a.coefficients, b.coefficients) &&
           one->GetOutput()->GetLevels()[i].parentPoint == other->GetOutput()->GetLevels()[i].parentPoint;
  }
  return same;
}

TriangleTree
TreeOf(const MeshArrays & mesh, const Faces & faces)
{
  std::vector<TriangleTree::Triangle> triangles;
  for (const auto & f : faces)
  {
    triangles.push_back({ mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]] });
  }
  return TriangleTree(triangles);
}

/** Mean over the area, and largest, of the distance from faces to a tree, at points some 0.7 mm apart. */
json
Distance(const MeshArrays & mesh, const Faces & faces, const TriangleTree & tree)
{
  double sum = 0.0, area = 0.0, largest = 0.0;
  for (const auto & f : faces)
  {
    const Vector3 &a = mesh.points[f[0]], &b = mesh.points[f[1]], &c = mesh.points[f[2]];
    const double longest = std::sqrt(std::max({ (b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm() }));
    const int    n = std::max(1, static_cast<int>(std::ceil(longest / 0.7)));
    const double share = (b - a).cross(c - a).norm() / (n * n);
    for (int i = 0; i < n; ++i)
    {
      for (int j = 0; j < 2 * (n - i) - 1; ++j)
      {
        // Centroids of the n^2 parts of the triangle: upright ones at even j, others at odd j.
        const double u = (i + (j % 2 == 0 ? 1.0 : 2.0) / 3.0) / n, v = (j / 2 + (j % 2 == 0 ? 1.0 : 2.0) / 3.0) / n;
        const double distance = std::sqrt(tree.FindNearest(a + u * (b - a) + v * (c - a)).squaredDistance);
        sum += share * distance;
        area += share;
        largest = std::max(largest, distance);
      }
    }
  }
  return { { "mean", area > 0 ? sum / area : 0.0 }, { "largest", largest } };
}

/** Smallest dihedral angle of the cells of the cortical region, or of the others, degrees. */
double
LeastAngle(const MeshArrays & mesh, bool cortical)
{
  double worst = -1.0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 & v = mesh.tetrahedra[t];
    if ((mesh.region[t] == Cortical) == cortical)
    {
      const auto & p = mesh.points;
      worst = std::max(worst, LargestDihedralCosine(p[v[0]], p[v[1]], p[v[2]], p[v[3]]));
    }
  }
  return std::acos(std::min(1.0, worst)) * Degree;
}

/** Mean of the cells' smallest dihedral angles, degrees, and how many are below what finite elements want. */
json
AnglesOf(const MeshArrays & mesh)
{
  const TetraCollapseParameters wanted;
  double                        sum = 0.0;
  int                           below = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 &  v = mesh.tetrahedra[t];
    const auto & p = mesh.points;
    const double angle = std::acos(LargestDihedralCosine(p[v[0]], p[v[1]], p[v[2]], p[v[3]]));
    const bool   cortical = mesh.region[t] == Cortical;
    sum += angle;
    below += angle < (cortical ? wanted.wantedCorticalDihedralAngle : wanted.wantedDihedralAngle) ? 1 : 0;
  }
  return { { "mean", sum / mesh.tetrahedra.size() * Degree }, { "below", below } };
}

json
Audit(const MeshArrays & first, const MeshArrays & level)
{
  const auto          validation = ValidateMesh(level);
  const std::set<int> regions(first.region.begin(), first.region.end());
  json                out;
  out["valid"] = validation.IsValid();
  out["summary"] = validation.Summary();
  out["angleCortical"] = LeastAngle(level, true);
  out["angleOther"] = LeastAngle(level, false);
  out["angles"] = AnglesOf(level);
  for (int region : regions)
  {
    const Faces faces = BoundaryFaces(level, region), before = BoundaryFaces(first, region);
    json        found;
    found["region"] = region;
    found["volume"] = test::RegionVolume(first, region);
    found["volumeChange"] = test::RegionVolume(level, region) / test::RegionVolume(first, region) - 1.0;
    found["faces"] = faces.size();
    found["crossing"] = FindCrossingTriangles(faces, level.points).size();
    found["pinched"] = PinchedPoints(level, region);
    found["to"] = Distance(level, faces, TreeOf(first, before));
    found["from"] = Distance(first, before, TreeOf(level, faces));
    out["regions"].push_back(found);
  }
  return out;
}

/** Where the bone is in its CT. */
struct Images
{
  CTImage::Pointer    ct;
  LabelImage::Pointer labels;
  int                 label;
};

json
DensityError(const MeshArrays & mesh, const Images & images)
{
  const float * density = images.ct->GetBufferPointer();
  const short * labels = images.labels->GetBufferPointer();
  const int     label = images.label;
  const auto    found = CompareDensity(
    mesh, MakeVoxelGrid(*images.ct, images.ct->GetBufferedRegion()), [=](std::size_t offset, double & value) {
      value = density[offset];
      return label == 0 ? labels[offset] != 0 : labels[offset] == label;
    });
  return { { "percent", found.meanAbsolutePercent },
           { "deviation", 100.0 * found.standardDeviation / found.range },
           { "voxels", found.voxels },
           { "uncovered", 100.0 * found.uncovered / (found.voxels + found.uncovered) } };
}

int
Levels(const std::string &         file,
       const std::string &         prefix,
       const Images &              images,
       const std::vector<IdType> & counts,
       bool                        improveAngles)
{
  const auto mesh = ReadDensityMesh(file);
  const auto filter = MakeFilter(mesh, counts, 2, improveAngles);
  const auto seconds = TimeOf(filter);
  const auto again = MakeFilter(mesh, counts, 2, improveAngles),
             single = MakeFilter(mesh, counts, 1, improveAngles);
  again->Update();
  single->Update();
  WriteHierarchy(filter->GetOutput(), prefix);
  json out;
  out["seconds"] = seconds.first;
  out["processorSeconds"] = seconds.second;
  out["same"] = IsSame(filter, again) && IsSame(filter, single);
  const auto first = mesh->GetArrays();
  for (std::size_t i = 0; i < filter->GetOutput()->GetNumberOfLevels(); ++i)
  {
    const auto & level = filter->GetOutput()->GetLevels()[i];
    json         found = Audit(first, level.mesh->GetArrays());
    found["density"] = DensityError(level.mesh->GetArrays(), images);
    found["tetrahedra"] = level.mesh->GetNumberOfTetrahedra();
    found["points"] = level.mesh->GetNumberOfPoints();
    found["asked"] = i == 0 ? level.mesh->GetNumberOfTetrahedra() : counts[i - 1];
    found["stopReason"] = level.stopReason;
    found["densityError"] = level.densityError;
    found["surfaceError"] = level.surfaceError;
    for (int reason = 1; i > 0 && reason < MeshOperationCount; ++reason)
    {
      found["refused"][MeshOperationName(static_cast<MeshOperation>(reason))] =
        filter->GetReport()[i - 1].refused[reason];
    }
    out["levels"].push_back(found);
  }
  std::cout << out.dump(1) << '\n';
  return 0;
}

int
Compare(const std::string & file, const Images & images)
{
  std::cout << DensityError(ReadMeshArrays(file), images) << '\n';
  return 0;
}

int
Time(const std::string & file, int repeat, const std::vector<IdType> & counts)
{
  const auto mesh = ReadDensityMesh(file);
  double     wall = std::numeric_limits<double>::max(), processor = wall;
  for (int k = 0; k < repeat; ++k)
  {
    const auto seconds = TimeOf(MakeFilter(mesh, counts, 2));
    wall = std::min(wall, seconds.first);
    processor = std::min(processor, seconds.second);
  }
  std::cout << json{
    { "tetrahedra", mesh->GetNumberOfTetrahedra() }, { "seconds", wall }, { "processorSeconds", processor }
  } << '\n';
  return 0;
}
/** Random bodies, every twentieth tiled from random contours, each under random bounds. */
int
Property(unsigned first, unsigned last)
{
  int    failed = 0;
  double ratio = 0.0;
  for (unsigned seed = first; seed <= last; ++seed)
  {
    std::string failures;
    try
    {
      MeshArrays body;
      if (seed % 20 == 0)
      {
        TilingReport report;
        body = TileContours(*RandomStack(seed).Make(), {}, report);
      }
      else
      {
        body = test::RandomBody(seed);
      }
      test::CollapseProperty property(body, seed);
      failures = property.Check();
      ratio = std::max(ratio, property.DensityRatio());
    }
    catch (const std::exception & error)
    {
      failures = error.what();
    }
    if (!failures.empty())
    {
      ++failed;
      std::cout << "seed " << seed << ": " << failures << std::endl;
    }
  }
  std::cout << json{ { "meshes", last - first + 1 }, { "failed", failed }, { "densityRatio", ratio } } << '\n';
  return failed > 0 ? 1 : 0;
}
} // namespace

int
main(int argc, char * argv[])
{
  const std::string   job = argc > 1 ? argv[1] : "";
  std::vector<IdType> counts;
  for (int i = job == "levels" || job == "angles" ? 7 : job == "time" ? 4 : argc; i < argc; ++i)
  {
    counts.push_back(std::stoi(argv[i]));
  }
  try
  {
    if ((job == "levels" || job == "angles") && argc > 7)
    {
      const Images images{ ReadCT(argv[4]), ReadLabels(argv[5]), std::stoi(argv[6]) };
      return Levels(argv[2], argv[3], images, counts, job == "angles");
    }
    if (job == "property" && argc == 4)
    {
      return Property(static_cast<unsigned>(std::stoul(argv[2])), static_cast<unsigned>(std::stoul(argv[3])));
    }
    if (job == "compare" && argc == 6)
    {
      return Compare(argv[2], { ReadCT(argv[3]), ReadLabels(argv[4]), std::stoi(argv[5]) });
    }
    if (job == "time" && argc > 4)
    {
      return Time(argv[2], std::stoi(argv[3]), counts);
    }
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
  std::cerr << "usage: boneSimplificationValidation levels|angles L1.vtu PREFIX CT LABELS LABEL COUNT... | time L1.vtu REPEAT "
               "COUNT... | "
               "property FIRST LAST | compare MESH.vtu CT LABELS LABEL\n";
  return 2;
}
