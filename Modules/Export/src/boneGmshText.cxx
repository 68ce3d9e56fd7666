/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementText.h"

#include <map>

namespace bone
{
namespace
{
/** Gmsh's types of elements. */
constexpr int Triangle3 = 2, Tetrahedron4 = 4, Triangle6 = 9, Tetrahedron10 = 11, Point1 = 15;
/** Gmsh has the nodes on the edges 23 and 13 the other way round. */
constexpr std::array<int, 10> NodeOrder = { 0, 1, 2, 3, 4, 5, 6, 7, 9, 8 };

/** The elements of one region and material: a volume. */
using GmshVolumes = std::map<std::pair<int, int>, std::vector<IdType>>;

GmshVolumes
FindVolumes(const FiniteElementModel & model)
{
  GmshVolumes volumes;
  for (std::size_t e = 0; e < model.elements.size(); ++e)
  {
    volumes[{ model.region[e], model.material[e] }].push_back(static_cast<IdType>(e));
  }
  return volumes;
}

/** Numbers of the physical groups: of a dimension, in the order of their names in $PhysicalNames. */
struct GmshGroups
{
  std::map<std::string, int> volumes;
  int                        exterior{ 1 };
};

GmshGroups
AddNames(const FiniteElementModel & model, FiniteElementText & text)
{
  GmshGroups groups;
  text << "$PhysicalNames\n" << model.nodeSets.size() + model.elementSets.size() + 1 << '\n';
  for (std::size_t i = 0; i < model.nodeSets.size(); ++i)
  {
    text << "0 " << i + 1 << " \"" << model.nodeSets[i].name << "\"\n";
  }
  text << "2 " << groups.exterior << " \"EXTERIOR\"\n";
  for (std::size_t i = 0; i < model.elementSets.size(); ++i)
  {
    groups.volumes[model.elementSets[i].name] = static_cast<int>(i) + 1;
    text << "3 " << i + 1 << " \"" << model.elementSets[i].name << "\"\n";
  }
  text << "$EndPhysicalNames\n";
  return groups;
}

void
AddPoint(const Vector3 & x, FiniteElementText & text)
{
  text << x.x() << ' ' << x.y() << ' ' << x.z() << ' ';
}

void
AddEntities(const FiniteElementModel & model,
            const GmshVolumes &        volumes,
            const GmshGroups &         groups,
            FiniteElementText &        text)
{
  Vector3 low = model.nodes.front(), high = low;
  for (const Vector3 & x : model.nodes)
  {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  text << "$Entities\n" << model.nodeSets.size() << " 0 1 " << volumes.size() << '\n';
  for (std::size_t i = 0; i < model.nodeSets.size(); ++i)
  {
    text << i + 1 << ' ';
    AddPoint(model.nodes[static_cast<std::size_t>(model.nodeSets[i].ids.front())], text);
    text << "1 " << i + 1 << '\n';
  }
  const auto box = [&](std::size_t tag) {
    text << tag << ' ';
    AddPoint(low, text);
    AddPoint(high, text);
  };
  box(1);
  text << "1 " << groups.exterior << " 0\n";
  std::size_t tag = 0;
  for (const auto & volume : volumes)
  {
    box(++tag);
    const auto & [region, material] = volume.first;
    text << "2 " << groups.volumes.at("REGION_" + std::to_string(region)) << ' '
         << groups.volumes.at("MAT_" + std::to_string(material + 1)) << " 0\n";
  }
  text << "$EndEntities\n";
}

void
AddNodes(const FiniteElementModel & model, FiniteElementText & text)
{
  const std::size_t count = model.nodes.size();
  text << "$Nodes\n1 " << count << " 1 " << count << "\n3 1 0 " << count << '\n';
  for (std::size_t n = 0; n < count; ++n)
  {
    text << n + 1 << '\n';
  }
  for (const Vector3 & x : model.nodes)
  {
    text << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  }
  text << "$EndNodes\n";
}

/** Points and triangles are numbered after the tetrahedra, which keep their numbers. Returns how many there are. */
std::size_t
AddElements(const FiniteElementModel & model, const GmshVolumes & volumes, FiniteElementText & text)
{
  std::size_t points = 0;
  for (const FiniteElementSet & set : model.nodeSets)
  {
    points += set.ids.size();
  }
  const std::size_t count = model.elements.size() + model.exterior.size() + points;
  text << "$Elements\n" << volumes.size() + 1 + model.nodeSets.size() << ' ' << count << " 1 " << count << '\n';
  std::size_t number = model.elements.size();
  for (std::size_t i = 0; i < model.nodeSets.size(); ++i)
  {
    text << "0 " << i + 1 << ' ' << Point1 << ' ' << model.nodeSets[i].ids.size() << '\n';
    for (const IdType node : model.nodeSets[i].ids)
    {
      text << ++number << ' ' << node + 1 << '\n';
    }
  }
  text << "2 1 " << (model.order == 2 ? Triangle6 : Triangle3) << ' ' << model.exterior.size() << '\n';
  for (const FiniteElementFace & face : model.exterior)
  {
    text << ++number;
    for (const IdType node : FiniteElementFaceNodes(model, face))
    {
      text << ' ' << node + 1;
    }
    text << '\n';
  }
  std::size_t tag = 0;
  for (const auto & volume : volumes)
  {
    text << "3 " << ++tag << ' ' << (model.order == 2 ? Tetrahedron10 : Tetrahedron4) << ' ' << volume.second.size()
         << '\n';
    for (const IdType e : volume.second)
    {
      text << e + 1;
      for (std::size_t i = 0; i < static_cast<std::size_t>(model.NodesEach()); ++i)
      {
        text << ' ' << model.elements[static_cast<std::size_t>(e)][static_cast<std::size_t>(NodeOrder[i])] + 1;
      }
      text << '\n';
    }
  }
  text << "$EndElements\n";
  return count;
}

/** A section of data: a number for each of `count` nodes or elements, which `add` writes, a line each. */
template <typename TAdd>
void
AddData(const char * section, const char * name, std::size_t count, FiniteElementText & text, TAdd && add)
{
  text << '$' << section << "\n1\n\"" << name << "\"\n1\n0\n3\n0\n1\n" << count << '\n';
  add([&text](std::size_t number, double value) { text << number << ' ' << value << '\n'; });
  text << "$End" << section << '\n';
}

/** The modulus of every element in the order of $Elements, as readers expect that take no notice of the numbers: points
 * have that of their node, triangles that of their tetrahedron. */
void
AddModuli(const FiniteElementModel & model, const GmshVolumes & volumes, std::size_t count, FiniteElementText & text)
{
  AddData("ElementData", "YoungsModulus", count, text, [&](const auto & add) {
    std::size_t number = model.elements.size();
    for (const FiniteElementSet & set : model.nodeSets)
    {
      for (const IdType node : set.ids)
      {
        add(++number, model.nodeModulus[static_cast<std::size_t>(node)]);
      }
    }
    for (const FiniteElementFace & face : model.exterior)
    {
      add(++number, model.modulus[static_cast<std::size_t>(face.element)]);
    }
    for (const auto & volume : volumes)
    {
      for (const IdType e : volume.second)
      {
        add(static_cast<std::size_t>(e) + 1, model.modulus[static_cast<std::size_t>(e)]);
      }
    }
  });
  AddData("NodeData", "YoungsModulus", model.nodes.size(), text, [&](const auto & add) {
    for (std::size_t n = 0; n < model.nodes.size(); ++n)
    {
      add(n + 1, model.nodeModulus[n]);
    }
  });
}
} // namespace

std::string
GmshText(const FiniteElementModel & model)
{
  FiniteElementText text;
  text << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\n";
  text.AddDescription(model, "");
  text << "$EndComments\n";
  const GmshVolumes volumes = FindVolumes(model);
  const GmshGroups  groups = AddNames(model, text);
  AddEntities(model, volumes, groups, text);
  AddNodes(model, text);
  AddModuli(model, volumes, AddElements(model, volumes, text), text);
  return text.GetText();
}
} // namespace bone
