/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementText.h"

namespace bone
{
namespace
{
/** Density and modulus as they stand in their elements: numbers, or with type="map" the names of maps. */
struct MaterialText
{
  std::string name, density, modulus;
};

void
AddMaterial(const MaterialText & material, std::size_t number, double poissonRatio, FiniteElementText & text)
{
  text << "    <material id=\"" << number << "\" name=\"" << material.name << "\" type=\"isotropic elastic\">\n      "
       << material.density << "\n      " << material.modulus << "\n      <v>" << poissonRatio
       << "</v>\n    </material>\n";
}

/** A block of elements, which is a part of one material. */
void
AddElements(const FiniteElementModel & model, const FiniteElementSet & part, FiniteElementText & text)
{
  text << "    <Elements type=\"" << (model.order == 2 ? "tet10" : "tet4") << "\" name=\"" << part.name << "\">\n";
  for (const IdType e : part.ids)
  {
    text << "      <elem id=\"" << e + 1 << "\">";
    for (int i = 0; i < model.NodesEach(); ++i)
    {
      text << (i > 0 ? "," : "") << model.elements[static_cast<std::size_t>(e)][static_cast<std::size_t>(i)] + 1;
    }
    text << "</elem>\n";
  }
  text << "    </Elements>\n";
}

void
AddSurface(const FiniteElementModel & model, FiniteElementText & text)
{
  const char * shape = model.order == 2 ? "tri6" : "tri3";
  text << "    <Surface name=\"EXTERIOR\">\n";
  for (std::size_t f = 0; f < model.exterior.size(); ++f)
  {
    text << "      <" << shape << " id=\"" << f + 1 << "\">";
    const char * between = "";
    for (const IdType node : FiniteElementFaceNodes(model, model.exterior[f]))
    {
      text << between << node + 1;
      between = ",";
    }
    text << "</" << shape << ">\n";
  }
  text << "    </Surface>\n";
}

void
AddSets(const char * element, const std::vector<FiniteElementSet> & sets, FiniteElementText & text)
{
  for (const FiniteElementSet & set : sets)
  {
    text << "    <" << element << " name=\"" << set.name << "\">\n";
    text.AddIds(set.ids, 12);
    text << "    </" << element << ">\n";
  }
}

/** Parts of the mesh: the materials' elements, or all in one. */
std::vector<FiniteElementSet>
MakeParts(const FiniteElementModel & model)
{
  std::vector<FiniteElementSet> parts;
  if (model.parameters.modulusField == ModulusField::Cells)
  {
    parts.push_back({ "BONE", {} });
    for (std::size_t e = 0; e < model.elements.size(); ++e)
    {
      parts[0].ids.push_back(static_cast<IdType>(e));
    }
    return parts;
  }
  for (const FiniteElementSet & set : model.elementSets)
  {
    if (set.name.rfind("MAT_", 0) == 0)
    {
      parts.push_back(set);
    }
  }
  return parts;
}

void
AddMaterials(const FiniteElementModel & model, FiniteElementText & text)
{
  const double nu = model.parameters.poissonRatio;
  if (model.parameters.modulusField == ModulusField::Cells)
  {
    AddMaterial(
      { "BONE", "<density type=\"map\">MassDensity</density>", "<E type=\"map\">YoungsModulus</E>" }, 1, nu, text);
    return;
  }
  for (std::size_t m = 0; m < model.materials.size(); ++m)
  {
    FiniteElementText density, modulus;
    density << "<density>" << model.materials[m].massDensity << "</density>";
    modulus << "<E>" << model.materials[m].modulus << "</E>";
    AddMaterial({ "MAT_" + std::to_string(m + 1), density.GetText(), modulus.GetText() }, m + 1, nu, text);
  }
}

/** A number for each element of BONE. */
void
AddMap(const char * name, const std::vector<double> & values, FiniteElementText & text)
{
  text << "    <ElementData name=\"" << name << "\" elem_set=\"BONE\">\n";
  for (std::size_t e = 0; e < values.size(); ++e)
  {
    text << "      <e lid=\"" << e + 1 << "\">" << values[e] << "</e>\n";
  }
  text << "    </ElementData>\n";
}
} // namespace

std::string
FEBioText(const FiniteElementModel & model)
{
  FiniteElementText text;
  text << "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<febio_spec version=\"4.0\">\n";
  text.AddDescription(model, "  <!-- ", " -->\n");
  text << "  <Module type=\"solid\"/>\n  <Material>\n";
  AddMaterials(model, text);
  text << "  </Material>\n  <Mesh>\n    <Nodes name=\"NODES\">\n";
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
  {
    const Vector3 & x = model.nodes[n];
    text << "      <node id=\"" << n + 1 << "\">" << x.x() << ',' << x.y() << ',' << x.z() << "</node>\n";
  }
  text << "    </Nodes>\n";
  const std::vector<FiniteElementSet> parts = MakeParts(model);
  for (const FiniteElementSet & part : parts)
  {
    AddElements(model, part, text);
  }
  AddSurface(model, text);
  std::vector<FiniteElementSet> elementSets;
  for (const FiniteElementSet & set : model.elementSets)
  {
    if (set.name.rfind("MAT_", 0) != 0 || parts.front().name == "BONE") // a part is a set already
    {
      elementSets.push_back(set);
    }
  }
  AddSets("ElementSet", elementSets, text);
  AddSets("NodeSet", model.nodeSets, text);
  text << "  </Mesh>\n  <MeshDomains>\n";
  for (const FiniteElementSet & part : parts)
  {
    text << "    <SolidDomain name=\"" << part.name << "\" mat=\"" << part.name << "\"/>\n";
  }
  text << "  </MeshDomains>\n";
  if (model.parameters.modulusField == ModulusField::Cells)
  {
    text << "  <MeshData>\n";
    AddMap("YoungsModulus", model.modulus, text);
    AddMap("MassDensity", model.massDensity, text);
    text << "  </MeshData>\n";
  }
  text << "</febio_spec>\n";
  return text.GetText();
}
} // namespace bone
