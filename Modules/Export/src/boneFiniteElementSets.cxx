/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementSets.h"

#include "boneSurfaceComplex.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <stdexcept>

namespace bone
{
namespace
{
using Nodes = std::set<IdType>;

void
AddFaceNodes(const FiniteElementModel & model, const FiniteElementFace & face, Nodes & nodes)
{
  const auto ids = FiniteElementFaceNodes(model, face);
  nodes.insert(ids.begin(), ids.end());
}

double
FaceArea(const FiniteElementModel & model, const FiniteElementFace & face)
{
  const auto ids = FiniteElementFaceNodes(model, face);
  const auto x = [&](std::size_t i) { return model.nodes[static_cast<std::size_t>(ids[i])]; };
  return 0.5 * (x(1) - x(0)).cross(x(2) - x(0)).norm();
}

FiniteElementSet
NameSet(const std::string & name, const Nodes & nodes)
{
  return { name, { nodes.begin(), nodes.end() } };
}

/** Sets of elements with the same number, PREFIX_number, ascending. */
void
AddNumberedSets(const std::string & prefix, const std::vector<int> & numbers, int first, FiniteElementModel & model)
{
  std::map<int, std::vector<IdType>> sets;
  for (std::size_t e = 0; e < numbers.size(); ++e)
  {
    sets[numbers[e] + first].push_back(static_cast<IdType>(e));
  }
  for (const auto & [number, ids] : sets)
  {
    model.elementSets.push_back({ prefix + std::to_string(number), ids });
  }
}

/** EXTERIOR, BOUNDARY, INTERFACE_2, ..., CUT_1, ... */
void
AddSurfaceSets(const MeshArrays & mesh, FiniteElementModel & model)
{
  const SurfaceComplex                    complex = FindSurfaces(mesh);
  Nodes                                   boundary;
  std::map<int, Nodes>                    interfaces;
  std::map<int, std::pair<double, Nodes>> cuts;
  for (std::size_t t = 0; t < complex.faceSurface.size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      const IdType number = complex.faceSurface[t][static_cast<std::size_t>(i)];
      if (number < 0)
      {
        continue;
      }
      const auto &            surface = complex.surfaces[static_cast<std::size_t>(number)];
      const FiniteElementFace face{ static_cast<IdType>(t), i };
      if (!surface.IsBoundary())
      {
        AddFaceNodes(model, face, interfaces[surface.inner]);
        continue;
      }
      model.exterior.push_back(face);
      AddFaceNodes(model, face, boundary);
      if (surface.flat >= 0)
      {
        auto & cut = cuts[surface.flat];
        cut.first += FaceArea(model, face);
        AddFaceNodes(model, face, cut.second);
      }
    }
  }
  model.nodeSets.push_back(NameSet("BOUNDARY", boundary));
  for (const auto & [inner, nodes] : interfaces)
  {
    model.nodeSets.push_back(NameSet("INTERFACE_" + std::to_string(inner), nodes));
  }
  std::vector<std::pair<double, Nodes>> ordered;
  for (auto & cut : cuts)
  {
    ordered.push_back(std::move(cut.second));
  }
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto & a, const auto & b) { return a.first > b.first; });
  for (std::size_t i = 0; i < ordered.size(); ++i)
  {
    model.nodeSets.push_back(NameSet("CUT_" + std::to_string(i + 1), ordered[i].second));
  }
}

/** END_LOW_X to END_HIGH_Z. */
void
AddEndSets(FiniteElementModel & model)
{
  constexpr double share = 0.03;
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto [low, high] =
      std::minmax_element(model.nodes.begin(), model.nodes.end(), [axis](const Vector3 & a, const Vector3 & b) {
        return a[axis] < b[axis];
      });
    const double      from = (*low)[axis], to = (*high)[axis];
    const std::string letter(1, static_cast<char>('X' + axis));
    FiniteElementSet  lowEnd{ "END_LOW_" + letter, {} }, highEnd{ "END_HIGH_" + letter, {} };
    for (std::size_t n = 0; n < model.nodes.size(); ++n)
    {
      const double x = model.nodes[n][axis];
      if (x <= from + share * (to - from))
      {
        lowEnd.ids.push_back(static_cast<IdType>(n));
      }
      if (x >= to - share * (to - from))
      {
        highEnd.ids.push_back(static_cast<IdType>(n));
      }
    }
    model.nodeSets.push_back(lowEnd);
    model.nodeSets.push_back(highEnd);
  }
}

std::string
LandmarkSetName(const std::string & name)
{
  std::string set = "LM_";
  for (const char c : name)
  {
    set += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  }
  return set;
}

void
AddLandmarkSets(const MeshArrays & mesh, const std::vector<Landmark> & landmarks, FiniteElementModel & model)
{
  std::set<std::string> names;
  for (const Landmark & landmark : landmarks)
  {
    const auto next =
      std::min_element(mesh.points.begin(), mesh.points.end(), [&landmark](const Vector3 & a, const Vector3 & b) {
        return (a - landmark.point).squaredNorm() < (b - landmark.point).squaredNorm();
      });
    const std::string name = LandmarkSetName(landmark.name);
    if ((*next - landmark.point).norm() > FarthestLandmark)
    {
      throw std::invalid_argument("The landmark " + landmark.name +
                                  " lies further than 45 mm from the model: is it of "
                                  "another bone, or another space?");
    }
    std::string upper = name; // Abaqus and CalculiX do not tell cases apart
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
    if (!names.insert(upper).second)
    {
      throw std::invalid_argument("Two landmarks would have the node set " + name + ": rename one.");
    }
    model.nodeSets.push_back({ name, { static_cast<IdType>(next - mesh.points.begin()) } });
  }
}
} // namespace

void
AddFiniteElementSets(const MeshArrays & mesh, const std::vector<Landmark> & landmarks, FiniteElementModel & model)
{
  AddNumberedSets("REGION_", model.region, 0, model);
  AddNumberedSets("MAT_", model.material, 1, model);
  AddSurfaceSets(mesh, model);
  AddEndSets(model);
  AddLandmarkSets(mesh, landmarks, model);
}
} // namespace bone
