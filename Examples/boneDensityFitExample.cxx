/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// The density of a CT as polynomials of degree 3 in every tetrahedron, and its mass:
// boneDensityFitExample CT MESH.vtu MODEL.vtu

#include "boneBernstein.h"
#include "boneDensityFitFilter.h"
#include "boneImageIO.h"
#include "boneMeshIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 4)
  {
    std::cerr << "usage: boneDensityFitExample CT MESH.vtu MODEL.vtu\n";
    return EXIT_FAILURE;
  }
  try
  {
    auto fit = bone::DensityFitFilter<bone::CTImage, bone::DensityMesh<double>>::New();
    fit->SetImage(bone::ReadCT(argv[1]));
    fit->SetMesh(bone::ReadDensityMesh(argv[2]));
    fit->SetDegree(3);
    fit->Update();

    // The integral of a Bernstein polynomial is its volume times the mean of its coefficients.
    const bone::MeshArrays model = fit->GetOutput()->GetArrays();
    const int              count = bone::BernsteinCount(model.maximumDegree);
    double                 volume = 0.0;
    double                 integral = 0.0;
    for (std::size_t t = 0; t < model.tetrahedra.size(); ++t)
    {
      const bone::Id4 & v = model.tetrahedra[t];
      const double      cell =
        bone::SignedVolume(model.points[v[0]], model.points[v[1]], model.points[v[2]], model.points[v[3]]);
      volume += cell;
      integral += bone::BernsteinIntegral(model.degree[t], &model.coefficients[t * count], cell);
    }
    std::cout << volume << " mm^3, mean density " << integral / volume << '\n';
    bone::WriteDensityMesh(fit->GetOutput(), argv[3]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
