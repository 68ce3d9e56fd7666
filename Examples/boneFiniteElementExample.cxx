/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// A model for a solver, by a law of Young's modulus: boneFiniteElementExample MODEL.vtu INTERCEPT SLOPE OUT.inp
// (ash density in g/cm^3 = INTERCEPT + SLOPE * HU)

#include "boneDensityCalibration.h"
#include "boneFiniteElementIO.h"
#include "boneMeshIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 5)
  {
    std::cerr << "usage: boneFiniteElementExample MODEL.vtu INTERCEPT SLOPE OUT.inp\n";
    return EXIT_FAILURE;
  }
  try
  {
    bone::MeshArrays mesh = bone::ReadMeshArrays(argv[1]);
    bone::DensityLaw line;
    line.to = bone::DensityQuantity::AshGramPerCubicCentimetre;
    line.intercept = std::stod(argv[2]);
    line.slope = std::stod(argv[3]);
    bone::ConvertDensity(mesh, line);

    const bone::ElasticityLaw & law = bone::FindElasticityLaw("keyak1998");
    const auto                  model = bone::MakeFiniteElements(mesh, law);
    std::cout << law.DescribeRelation() << " (" << law.source << ")\n"
              << model.elements.size() << " elements, " << model.materials.size() << " materials, the softest of "
              << model.materials.front().modulus << " MPa, the stiffest of " << model.materials.back().modulus
              << " MPa\n";
    bone::WriteFiniteElements(model, bone::FiniteElementFormat::CalculiX, argv[4]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
