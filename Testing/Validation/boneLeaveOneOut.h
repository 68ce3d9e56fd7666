/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLeaveOneOut_h
#define boneLeaveOneOut_h

#include "boneMeshIO.h"
#include "boneStatisticalModelEstimator.h"
#include "boneTriangleSurface.h"
#include "boneTriangleTree.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

/** \file What the validations that leave a subject out have in common. */
namespace bone
{
using NamedSubjects = std::vector<std::pair<std::string, MeshArrays>>;

/** The meshes of a folder, by their names. */
inline NamedSubjects
ReadSubjects(const std::string & folder)
{
  NamedSubjects subjects;
  for (const auto & entry : std::filesystem::directory_iterator(folder))
  {
    subjects.emplace_back(entry.path().stem().string(), ReadMeshArrays(entry.path().string()));
  }
  std::sort(subjects.begin(), subjects.end(), [](const auto & a, const auto & b) { return a.first < b.first; });
  return subjects;
}

/** The atlas of all subjects but one. */
inline StatisticalModelContent
Train(const NamedSubjects & subjects, const std::string & without)
{
  auto set = MeshTrainingSet<>::New();
  for (const auto & [name, arrays] : subjects)
  {
    if (name != without)
    {
      auto mesh = DensityMesh<double>::New();
      mesh->SetArrays(arrays);
      set->AddSubject(name, mesh);
    }
  }
  auto estimator = StatisticalModelEstimator<>::New();
  estimator->SetInput(set);
  estimator->SetVarianceProportion(1.0);
  estimator->SetOutlierThreshold(0.0);
  estimator->Update();
  return estimator->GetOutput()->GetContent();
}

struct Distances
{
  double mean{ 0.0 };
  double most{ 0.0 }; ///< 95 %
};

/** Of both surfaces' vertices to the other surface. \param from  least x of vertices that count */
inline Distances
Compare(const MeshArrays & mesh, const TriangleSurface & truth, double from = std::numeric_limits<double>::lowest())
{
  std::vector<TriangleTree::Triangle> ofMesh, ofTruth;
  std::vector<bool>                   outside(mesh.points.size(), false);
  for (const auto & face : BoundaryFaces(mesh))
  {
    ofMesh.push_back({ mesh.points[face[0]], mesh.points[face[1]], mesh.points[face[2]] });
    for (const IdType p : face)
    {
      outside[static_cast<std::size_t>(p)] = true;
    }
  }
  for (const auto & t : truth.triangles)
  {
    ofTruth.push_back({ truth.points[t[0]], truth.points[t[1]], truth.points[t[2]] });
  }
  const TriangleTree  meshTree(ofMesh), truthTree(ofTruth);
  std::vector<double> all;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
  {
    if (outside[p] && mesh.points[p].x() >= from)
    {
      all.push_back(std::sqrt(truthTree.FindNearest(mesh.points[p]).squaredDistance));
    }
  }
  for (std::size_t i = 0; i < truth.points.size(); i += 4)
  {
    if (truth.points[i].x() >= from)
    {
      all.push_back(std::sqrt(meshTree.FindNearest(truth.points[i]).squaredDistance));
    }
  }
  std::sort(all.begin(), all.end());
  Distances result;
  for (const double d : all)
  {
    result.mean += d / static_cast<double>(all.size());
  }
  result.most = all[all.size() * 95 / 100];
  return result;
}

} // namespace bone

#endif
