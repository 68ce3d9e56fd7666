/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneTilingValidation CONTOURS.vtp MESH.vtu [--branching KIND]: tiles contours and prints what the tiling met, a "name
// value" a line. boneTilingValidation --random SEED MESH.vtu [--branching KIND]: the same of a random stack.
#include "boneContourIO.h"
#include "boneContourTiler.h"
#include "boneMeshIO.h"
#include "boneQualityMeasures.h"
#include "boneRandomStack.h"
#include "boneSlabTopology.h"
#include "boneStackTopology.h"
#include "boneSurfaceAudit.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iostream>

namespace
{
bone::BranchingKind
BranchingOf(const std::string & name)
{
  const auto & names = bone::ParameterChoices<bone::BranchingKind>::names;
  const auto   found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
  {
    throw std::invalid_argument("--branching is none of composite, splitting, filling");
  }
  return static_cast<bone::BranchingKind>(found - names.begin());
}
} // namespace

int
main(int argc, char * argv[])
{
  bone::TilingGuide guide;
  const std::string branching = argc > 4 && std::string(argv[argc - 2]) == "--branching" ? argv[argc - 1] : "";
  argc -= branching.empty() ? 0 : 2;
  const bool random = argc == 4 && std::string(argv[1]) == "--random";
  if (argc != 3 && !random)
  {
    std::cerr << "usage: boneTilingValidation (CONTOURS.vtp | --random SEED) MESH.vtu [--branching KIND]\n";
    return 2;
  }
  try
  {
    guide.branching = branching.empty() ? guide.branching : BranchingOf(branching);
    const auto stack =
      random ? bone::RandomStack(static_cast<unsigned>(std::stoul(argv[2]))).Make() : bone::ReadContours(argv[1]);
    bone::TilingReport report;
    const std::clock_t start = std::clock();
    const auto         mesh = bone::TileContours(*stack, guide, report);
    const double       seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    double             least = 180.0, sum = 0.0;
    for (const bone::Id4 & c : mesh.tetrahedra)
    {
      const auto & p = mesh.points;
      const double cosine = bone::LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
      const double angle = std::acos(std::min(1.0, cosine)) * 57.29577951308232;
      least = std::min(least, angle);
      sum += angle;
    }
    std::size_t inner = 0, axes = 0, slices = 0;
    for (const bone::ContourSlice & slice : stack->GetSlices())
    {
      slices += slice.contours.empty() ? 0 : 1;
      for (const bone::Contour & contour : slice.contours)
      {
        inner += !contour.axis && contour.layer > 0;
        axes += contour.axis;
      }
    }
    int pinched = 0;
    for (int region = 1; region <= 3; ++region)
    {
      pinched += bone::PinchedPoints(mesh, region);
    }
    std::cout << "seconds " << seconds << "\nslices " << slices << "\ninner_contours " << inner << "\naxes " << axes
              << "\npinched " << pinched << "\npoints " << mesh.points.size() << "\ntetrahedra "
              << mesh.tetrahedra.size() << "\nslabs " << report.slabs << "\nbranchings " << report.branchings
              << "\nsplit_branchings " << report.splitBranchings << "\nfilled_branchings " << report.filledBranchings
              << "\nsplit_fillings " << report.splitFillings << "\nlayer_branchings " << report.layerBranchings
              << "\nfilled " << report.filledSlabs + report.filledEnds << "\nleft_out "
              << report.loopsLeftOut + report.holesLeftOut << "\nparted " << report.separatedGroups << "\npatches "
              << report.patches << "\nleast_angle " << least << "\nmean_angle "
              << sum / static_cast<double>(mesh.tetrahedra.size()) << '\n';
    const double pixel = random ? 0.1 : 0.2; // mm; random bodies have walls thinner than bones
    for (int region = 1; region <= 3; ++region)
    {
      const auto differing = bone::FindSlabsOfOtherTopology(mesh, *stack, report.correspondence, region, pixel);
      std::cout << "mesh_topology_" << region << ' ' << bone::TopologyOfMesh(mesh, region) << "\nstack_topology_"
                << region << ' ' << bone::TopologyOfStack(*stack, region, pixel) << "\ndiffering_slabs_" << region
                << ' ' << differing.size() << '\n';
      for (const std::string & line : differing)
      {
        std::cerr << line << '\n';
      }
    }
    bone::WriteMeshArrays(mesh, argv[argc - 1]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
