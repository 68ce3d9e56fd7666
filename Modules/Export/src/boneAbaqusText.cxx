/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementText.h"

namespace bone
{
namespace
{
/** The face's number in Abaqus by the corner opposite to it. */
constexpr std::array<int, 4> FaceNumber = { 3, 4, 2, 1 };

void
AddKeywordSets(const char *                          keyword,
               const char *                          option,
               const std::vector<FiniteElementSet> & sets,
               FiniteElementText &                   text)
{
  for (const FiniteElementSet & set : sets)
  {
    text << keyword << option << set.name << '\n';
    text.AddIds(set.ids, 12);
  }
}

void
AddBinnedMaterials(const FiniteElementModel & model, FiniteElementText & text)
{
  for (std::size_t m = 0; m < model.materials.size(); ++m)
  {
    text << "*MATERIAL, NAME=MAT_" << m + 1 << "\n*ELASTIC\n"
         << model.materials[m].modulus << ", " << model.parameters.poissonRatio << "\n*DENSITY\n"
         << model.materials[m].massDensity << "\n*SOLID SECTION, ELSET=MAT_" << m + 1 << ", MATERIAL=MAT_" << m + 1
         << '\n';
  }
}

/** A modulus of 1000 MPa is a temperature of 1: CalculiX keeps six digits after the point and none above 2147. */
constexpr double TemperaturePerModulus = 1e-3;

/** One material whose modulus is its temperature; its mass density goes with the modulus by bin. */
void
AddNodalMaterial(const FiniteElementModel & model, FiniteElementText & text)
{
  const auto [softest, stiffest] = std::minmax_element(model.nodeModulus.begin(), model.nodeModulus.end());
  const double high = std::max(*stiffest, 1.001 * *softest);
  text << "*MATERIAL, NAME=BONE\n*ELASTIC\n";
  for (const double modulus : { *softest, high })
  {
    text << modulus << ", " << model.parameters.poissonRatio << ", " << TemperaturePerModulus * modulus << '\n';
  }
  text << "*DENSITY\n";
  for (const FiniteElementMaterial & material : model.materials)
  {
    text << material.massDensity << ", " << TemperaturePerModulus * material.modulus << '\n';
  }
  text << "*SOLID SECTION, ELSET=BONE, MATERIAL=BONE\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\n";
  for (std::size_t n = 0; n < model.nodeModulus.size(); ++n)
  {
    text << n + 1 << ", " << TemperaturePerModulus * model.nodeModulus[n] << '\n';
  }
}
} // namespace

std::string
AbaqusText(const FiniteElementModel & model)
{
  FiniteElementText text;
  text.AddDescription(model, "** ");
  text << "*NODE, NSET=NODES\n";
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
  {
    const Vector3 & x = model.nodes[n];
    text << n + 1 << ", " << x.x() << ", " << x.y() << ", " << x.z() << '\n';
  }
  text << "*ELEMENT, TYPE=" << (model.order == 2 ? "C3D10" : "C3D4") << ", ELSET=BONE\n";
  for (std::size_t e = 0; e < model.elements.size(); ++e)
  {
    text << e + 1;
    for (int i = 0; i < model.NodesEach(); ++i)
    {
      text << ", " << model.elements[e][static_cast<std::size_t>(i)] + 1;
    }
    text << '\n';
  }
  AddKeywordSets("*ELSET, ", "ELSET=", model.elementSets, text);
  AddKeywordSets("*NSET, ", "NSET=", model.nodeSets, text);
  text << "*SURFACE, NAME=EXTERIOR, TYPE=ELEMENT\n";
  for (const FiniteElementFace & face : model.exterior)
  {
    text << face.element + 1 << ", S" << FaceNumber[static_cast<std::size_t>(face.opposite)] << '\n';
  }
  if (model.parameters.modulusField == ModulusField::Nodes)
  {
    AddNodalMaterial(model, text);
  }
  else
  {
    AddBinnedMaterials(model, text);
  }
  return text.GetText();
}
} // namespace bone
