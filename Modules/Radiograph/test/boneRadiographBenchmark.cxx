/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshDerivatives.h"

#include "boneMeshWalk.h"
#include "boneRadiographTestMeshes.h"
#include "boneVoxelRadiograph.h"

#include <benchmark/benchmark.h>

namespace
{
using namespace bone;

const Execution execution;

/** A bone-sized block of about `cells` jittered tetrahedra with a smooth density of the degree. */
MeshArrays
Block(int cells, int degree)
{
  const double side = std::cbrt(cells / 6.0 / 1.5);
  const int    nx = static_cast<int>(side), nz = static_cast<int>(1.5 * side);
  MeshArrays   mesh =
    test::GridMesh({ { nx, nx, nz } }, Vector3(-50, -50, -75), Vector3(100.0 / nx, 100.0 / nx, 150.0 / nz), 0.25);
  test::SetPowers(mesh, [degree](std::size_t) { return degree; }, { { 0.7, Vector3(0.002, 0.003, 0.001) } });
  return mesh;
}

XRayGeometry::View
FramedView()
{
  return XRayGeometry::Framing(
    Vector3(-50, -50, -75), Vector3(50, 50, 75), Vector3(0.3, 1, 0.1).normalized(), Vector3::UnitZ(), 800, 1100, 512);
}

/** One radiograph of many: the model is kept. */
void
Projection(benchmark::State & state)
{
  const auto            mesh = Block(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const auto            view = FramedView();
  const ProjectionModel model(mesh.points, mesh, {}, execution);
  std::vector<float>    image(static_cast<std::size_t>(view.size[0]) * view.size[1]);
  for (auto _ : state)
  {
    ProjectMesh(model, { view }, execution, { image.data() });
  }
  std::vector<std::int32_t> passed(image.size());
  WalkMesh(mesh.points, mesh, view, {}, execution, image.data(), passed.data());
  double intervals = 0;
  for (int count : passed)
  {
    intervals += count;
  }
  state.counters["cells"] = static_cast<double>(mesh.tetrahedra.size());
  state.counters["intervals"] = intervals;
  state.counters["intervals_per_second"] = benchmark::Counter(intervals, benchmark::Counter::kIsIterationInvariantRate);
}

/** The only radiograph of a mesh. */
void
ProjectionOnce(benchmark::State & state)
{
  const auto         mesh = Block(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const auto         view = FramedView();
  std::vector<float> image(static_cast<std::size_t>(view.size[0]) * view.size[1]);
  for (auto _ : state)
  {
    ProjectMesh(mesh.points, mesh, view, {}, execution, image.data());
  }
}

/** Poses of a search: 64 views of 128 x 128 pixels in one call. */
void
Search(benchmark::State & state)
{
  const auto            mesh = Block(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const ProjectionModel model(mesh.points, mesh, {}, execution);
  auto                  view = FramedView();
  view.spacing *= view.size[0] / 128.0;
  view.size = { { 128, 128 } };
  std::vector<XRayGeometry::View> views(64, view);
  std::vector<float>              images(views.size() * 128 * 128);
  std::vector<float *>            pointers;
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    views[i].source.x() += static_cast<double>(i);
    pointers.push_back(&images[i * 128 * 128]);
  }
  for (auto _ : state)
  {
    ProjectMesh(model, views, execution, pointers);
  }
  state.counters["views_per_second"] =
    benchmark::Counter(static_cast<double>(views.size()), benchmark::Counter::kIsIterationInvariantRate);
}

/** The image with its derivatives by 6 pose, 10 shape and 10 density modes. */
void
Derivatives(benchmark::State & state)
{
  const auto      mesh = Block(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const auto      view = FramedView();
  RadiographModes modes;
  modes.pose = true;
  for (int m = 0; m < 10; ++m)
  {
    modes.shape.emplace_back(mesh.points);
    modes.density.emplace_back(mesh.coefficients);
  }
  const std::size_t    pixels = static_cast<std::size_t>(view.size[0]) * view.size[1];
  std::vector<float>   images(pixels * (1 + modes.Count()));
  std::vector<float *> pointers;
  for (std::size_t i = 0; i < images.size(); i += pixels)
  {
    pointers.push_back(&images[i]);
  }
  const ProjectionModel model(mesh.points, mesh, {}, execution);
  for (auto _ : state)
  {
    ProjectMeshDerivatives(model, view, modes, execution, pointers);
  }
}

void
Backprojection(benchmark::State & state)
{
  const auto                 mesh = Block(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const auto                 view = FramedView();
  const std::vector<float>   image(static_cast<std::size_t>(view.size[0]) * view.size[1], 1.0f);
  std::vector<double>        coefficients(mesh.coefficients.size());
  std::vector<bone::Vector3> positions(mesh.points.size());
  const ProjectionModel      model(mesh.points, mesh, {}, execution);
  for (auto _ : state)
  {
    BackprojectToMesh(model, view, execution, image.data(), coefficients.data(), positions.data());
  }
}

void
Walk(benchmark::State & state)
{
  const auto         mesh = Block(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const auto         view = FramedView();
  std::vector<float> image(static_cast<std::size_t>(view.size[0]) * view.size[1]);
  for (auto _ : state)
  {
    WalkMesh(mesh.points, mesh, view, {}, execution, image.data(), nullptr);
  }
}
/** A voxel image of about the same body: 20 million voxels, as a clinical CT of a hip has. */
void
Voxels(benchmark::State & state)
{
  VoxelVolume grid;
  grid.size = { { 270, 270, 270 } };
  grid.values.assign(270 * 270 * 270, 1.0f);
  grid.origin = Vector3(-50, -50, -75);
  grid.axes = Vector3(100.0 / 270, 100.0 / 270, 150.0 / 270).asDiagonal();
  const auto         view = FramedView();
  std::vector<float> image(static_cast<std::size_t>(view.size[0]) * view.size[1]);
  for (auto _ : state)
  {
    ProjectVoxels(grid, view, execution, image.data());
  }
}
} // namespace

BENCHMARK(Projection)
  ->Args({ 33000, 0 })
  ->Args({ 33000, 2 })
  ->Args({ 33000, 3 })
  ->Args({ 33000, 8 })
  ->Args({ 6000, 3 })
  ->Args({ 300000, 3 })
  ->Unit(benchmark::kMillisecond)
  ->MeasureProcessCPUTime()
  ->UseRealTime();
BENCHMARK(ProjectionOnce)
  ->Args({ 33000, 3 })
  ->Args({ 300000, 3 })
  ->Unit(benchmark::kMillisecond)
  ->MeasureProcessCPUTime()
  ->UseRealTime();
BENCHMARK(Derivatives)
  ->Args({ 33000, 2 })
  ->Args({ 33000, 3 })
  ->Unit(benchmark::kMillisecond)
  ->MeasureProcessCPUTime()
  ->UseRealTime();
BENCHMARK(Search)->Args({ 2500, 3 })->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(Backprojection)->Args({ 33000, 3 })->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(Voxels)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(Walk)->Args({ 33000, 3 })->Unit(benchmark::kMillisecond)->UseRealTime();
