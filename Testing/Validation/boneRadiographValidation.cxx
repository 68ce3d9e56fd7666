/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneRadiographValidation CT GEOMETRY.json MODEL.vtu...: times radiographs of the models, kept and made anew, of the
// CT by Joseph's method and by ITK's RayCastInterpolateImageFunction, the first model's derivatives and adjoint, many
// small views of the last model as a search has them, and the first model as "close" with a detector a fifth as wide,
// which the bone fills; all with two threads. Prints a "name wall_ms processor_ms" a line, least of the repetitions,
// then for each model the cells on its rays.
// boneRadiographValidation first GEOMETRY.json MODEL.vtu: the first radiograph of this process, then the next ones of
// the same filter.
#include <itkIdentityTransform.h>
#include <itkRayCastInterpolateImageFunction.h> // before other versions of Eigen than ITK's

#include "boneGeometryIO.h"
#include "boneMeshWalk.h"
#include "boneImageIO.h"
#include "boneDRRImageFilter.h"
#include "boneMeshDerivatives.h"
#include "boneMeshIO.h"
#include "boneVoxelDRRImageFilter.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <iostream>

namespace
{
using namespace bone;

/** Loops on two threads; made after main() has set ITK's default. */
const Execution &
TwoThreads()
{
  static const Execution execution;
  return execution;
}

struct Work
{
  std::string           name;
  std::function<void()> run;
};

/** Runs the works in turn, so that all of them meet what else the machine does. */
void
Time(const std::vector<Work> & works, int repetitions)
{
  std::vector<double> wall(works.size(), 1e30), processor(works.size(), 1e30);
  for (int i = 0; i < repetitions; ++i)
  {
    for (std::size_t w = 0; w < works.size(); ++w)
    {
      const auto         start = std::chrono::steady_clock::now();
      const std::clock_t ticks = std::clock();
      works[w].run();
      processor[w] = std::min(processor[w], 1e3 * static_cast<double>(std::clock() - ticks) / CLOCKS_PER_SEC);
      wall[w] =
        std::min(wall[w], 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
  }
  for (std::size_t w = 0; w < works.size(); ++w)
  {
    std::cout << works[w].name << ' ' << wall[w] << ' ' << processor[w] << '\n';
  }
}

void
Time(const std::string & name, int repetitions, const std::function<void()> & work)
{
  Time({ { name, work } }, repetitions);
}

std::size_t
Pixels(const XRayGeometry::View & view)
{
  return static_cast<std::size_t>(view.size[0]) * view.size[1];
}

/** The same detector, all of it within the bone's shadow: pixels `share` as far apart about its middle. */
XRayGeometry::View
CloseView(XRayGeometry::View view, double share)
{
  const Vector2 half =
    0.5 * (1.0 - share) * Vector2((view.size[0] - 1) * view.spacing.x(), (view.size[1] - 1) * view.spacing.y());
  view.detectorOrigin += half.x() * view.detectorU + half.y() * view.detectorV;
  view.spacing *= share;
  return view;
}

void
TimeModel(const std::string & name, const std::string & path, const XRayGeometry::View & view)
{
  const MeshArrays   mesh = ReadDensityMesh(path)->GetArrays();
  std::vector<float> image(Pixels(view));
  // As one of many radiographs of a mesh, and as the only one.
  const ProjectionModel model(mesh.points, mesh, {}, TwoThreads());
  Time("model " + name, 600, [&]() { ProjectMesh(model, { view }, TwoThreads(), { image.data() }); });
  Time("once " + name, 40, [&]() { ProjectMesh(mesh.points, mesh, view, {}, TwoThreads(), image.data()); });
  std::vector<std::int32_t> passed(image.size());
  WalkMesh(mesh.points, mesh, view, {}, TwoThreads(), image.data(), passed.data());
  double intervals = 0, rays = 0;
  for (std::int32_t cells : passed)
  {
    intervals += cells;
    rays += cells > 0 ? 1 : 0;
  }
  std::cout << "cells " << name << ' ' << mesh.tetrahedra.size() << ' ' << intervals << ' ' << rays << '\n';
}

/** The image, its derivatives by 26 modes, and the image with the derivatives of a number by all points and
 * coefficients. */
void
TimeDerivatives(const std::string & path, const XRayGeometry::View & view)
{
  const MeshArrays mesh = ReadDensityMesh(path)->GetArrays();
  RadiographModes  modes;
  modes.pose = true;
  for (int m = 0; m < 10; ++m)
  {
    modes.shape.emplace_back(mesh.points);
    modes.density.emplace_back(mesh.coefficients);
  }
  std::vector<float>   images(Pixels(view) * (1 + modes.Count()));
  std::vector<float *> pointers;
  for (std::size_t i = 0; i < images.size(); i += Pixels(view))
  {
    pointers.push_back(&images[i]);
  }
  const ProjectionModel    model(mesh.points, mesh, {}, TwoThreads());
  const std::vector<float> weights(Pixels(view), 1.0f);
  std::vector<float>       image(Pixels(view));
  std::vector<double>      coefficients(mesh.coefficients.size());
  std::vector<Vector3>     positions(mesh.points.size());
  const auto               draw = [&]() { ProjectMesh(model, { view }, TwoThreads(), { image.data() }); };
  Time({ { "image", draw },
         { "derivatives", [&]() { ProjectMeshDerivatives(model, view, modes, TwoThreads(), pointers); } },
         { "adjoint",
           [&]() {
             draw();
             BackprojectToMesh(model, view, TwoThreads(), weights.data(), coefficients.data(), positions.data());
           } } },
       60);
}

/** 64 poses before a detector of 128 x 128 pixels, in one call and one by one. */
void
TimeSearch(const std::string & path, XRayGeometry::View view)
{
  constexpr int pixels = 128, poses = 64;
  view.spacing *= static_cast<double>(view.size[0]) / pixels;
  view.size = { { pixels, pixels } };
  const MeshArrays                mesh = ReadDensityMesh(path)->GetArrays();
  const ProjectionModel           model(mesh.points, mesh, {}, TwoThreads());
  std::vector<XRayGeometry::View> views(poses, view);
  std::vector<float>              images(poses * Pixels(view));
  std::vector<float *>            pointers;
  for (int i = 0; i < poses; ++i)
  {
    views[i].source += Vector3(3.0 * (i % 4), 2.0 * (i / 16), 3.0 * (i / 4 % 4));
    pointers.push_back(&images[i * Pixels(view)]);
  }
  Time({ { "search", [&]() { ProjectMesh(model, views, TwoThreads(), pointers); } },
         { "search_alone",
           [&]() {
             for (int i = 0; i < poses; ++i)
             {
               ProjectMesh(model, { views[i] }, TwoThreads(), { pointers[i] });
             }
           } } },
       40);
}

/** What a process waits for its first radiograph: threads, pages of memory, the model and the image; then what it waits
 * for more of the same model. */
void
TimeFirst(const std::string & path, XRayGeometry * geometry)
{
  auto drr = DRRImageFilter<DensityMesh<double>, CTImage>::New();
  drr->SetInput(ReadDensityMesh(path));
  drr->SetGeometry(geometry);
  const auto update = [&]() {
    geometry->Modified();
    drr->Update();
  };
  Time("first", 1, update);
  Time("kept", 20, update);
}

/** ITK's ray caster turns no axes: points are turned about the image's origin. It counts what is above 0. */
void
TimeRayCaster(const CTImage * ct, const XRayGeometry * geometry, const std::vector<float> & reference)
{
  using Interpolator = itk::RayCastInterpolateImageFunction<CTImage, double>;
  const auto &             view = geometry->GetView();
  const CTImage::PointType origin = ct->GetOrigin();
  const auto               inVolume = [&](const Vector3 & x) {
    CTImage::PointType point;
    for (unsigned int k = 0; k < 3; ++k)
    {
      point[k] = origin[k];
      for (unsigned int axis = 0; axis < 3; ++axis)
      {
        point[k] += ct->GetDirection()(axis, k) * (x[axis] - origin[axis]);
      }
    }
    return point;
  };
  std::vector<float> image(Pixels(view));
  const auto         cast = [&](std::size_t part) {
    auto interpolator = Interpolator::New();
    interpolator->SetInputImage(ct);
    interpolator->SetTransform(itk::IdentityTransform<double, 3>::New());
    interpolator->SetFocalPoint(inVolume(view.source));
    interpolator->SetThreshold(0);
    for (int row = static_cast<int>(part); row < view.size[1]; row += 16)
    {
      for (int column = 0; column < view.size[0]; ++column)
      {
        image[static_cast<std::size_t>(row) * view.size[0] + column] =
          static_cast<float>(interpolator->Evaluate(inVolume(geometry->GetPixelPoint(column, row))));
      }
    }
  };
  Time("itk", 2, [&]() { TwoThreads().For(16, cast); });
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < image.size(); ++i)
  {
    difference += std::abs(static_cast<double>(image[i]) - reference[i]);
    size += std::abs(static_cast<double>(reference[i]));
  }
  std::cout << "itk_difference " << difference / size << '\n';
}
} // namespace

int
main(int argc, char * argv[])
{
  if (argc < 4)
  {
    std::cerr << "usage: boneRadiographValidation CT|first GEOMETRY.json MODEL.vtu...\n";
    return 2;
  }
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(2);
  try
  {
    const auto geometry = ReadGeometry(argv[2]).front();
    if (argv[1] == std::string("first"))
    {
      TimeFirst(argv[3], geometry);
      return 0;
    }
    const auto ct = ReadCT(argv[1]);
    const auto voxels = ct->GetBufferedRegion().GetNumberOfPixels();
    std::transform(ct->GetBufferPointer(), ct->GetBufferPointer() + voxels, ct->GetBufferPointer(), [](float value) {
      return std::max(value, 0.0f);
    });
    for (int i = 3; i < argc; ++i)
    {
      TimeModel(argv[i], argv[i], geometry->GetView());
    }
    TimeModel("close", argv[3], CloseView(geometry->GetView(), 0.2));
    TimeDerivatives(argv[3], geometry->GetView());
    TimeSearch(argv[argc - 1], geometry->GetView());
    auto joseph = VoxelDRRImageFilter<CTImage, CTImage>::New();
    joseph->SetInput(ct);
    joseph->SetGeometry(geometry);
    joseph->SetNumberOfWorkUnits(2);
    Time("joseph", 3, [&]() {
      joseph->Modified();
      joseph->Update();
    });
    const float * pixels = joseph->GetOutput()->GetBufferPointer();
    TimeRayCaster(ct, geometry, std::vector<float>(pixels, pixels + Pixels(geometry->GetView())));
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
