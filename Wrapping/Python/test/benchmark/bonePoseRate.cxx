/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// Radiographs with derivatives by pose a second in C++, to compare with pose_rate.py:
// bonePoseRate MODEL.vtu GEOMETRY.json CALLS

#include "boneGeometryIO.h"
#include "boneMeshDerivatives.h"
#include "boneMeshIO.h"
#include "boneProjectionModel.h"
#include "boneRigidPose.h"

#include <chrono>
#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 4)
  {
    std::cerr << "usage: bonePoseRate MODEL.vtu GEOMETRY.json CALLS\n";
    return EXIT_FAILURE;
  }
  const bone::MeshArrays      mesh = bone::ReadMeshArrays(argv[1]);
  const auto                  view = bone::ReadGeometry(argv[2]).front()->GetView();
  const int                   calls = std::atoi(argv[3]);
  const bone::Execution       execution;
  const bone::ProjectionModel model(mesh.points, mesh, {}, execution);

  const std::size_t          pixels = static_cast<std::size_t>(view.size[0]) * static_cast<std::size_t>(view.size[1]);
  std::vector<float>         image(pixels);
  std::vector<double>        coefficients(mesh.coefficients.size());
  std::vector<bone::Vector3> positions(mesh.points.size());
  bone::RigidPose            pose;
  for (const bone::Vector3 & x : mesh.points)
  {
    pose.centre += x / static_cast<double>(mesh.points.size());
  }
  for (const bool backward : { false, true })
  {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < calls; ++i)
    {
      pose.translation.x() = 0.01 * i;
      const auto moved = pose.ToModelSpace(view);
      bone::ProjectMesh(model, { moved }, execution, { image.data() });
      if (backward)
      {
        bone::BackprojectToMesh(model, moved, execution, image.data(), coefficients.data(), positions.data());
      }
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::cout << (backward ? "value and gradient: " : "value: ") << calls / seconds.count() << " a second\n";
  }
  return EXIT_SUCCESS;
}
