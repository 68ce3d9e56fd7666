/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneRegistrationValidation: registers a model to X-rays simulated from the CT it was built of, from many starts; a
// line a start. See registration.py.
#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen

#include "boneAttenuationImageFilter.h"
#include "boneHierarchyIO.h"
#include "boneImageIO.h"
#include "boneRigidRegistration.h"
#include "boneVoxelDRRImageFilter.h"

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <itkRecursiveGaussianImageFilter.h>
#include <itkEuler3DTransform.h>
#include <itkZeroFluxNeumannPadImageFilter.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <iostream>
#include <random>

namespace
{
using namespace bone;

/** How an X-ray comes about. */
struct XRaySimulation
{
  double photons{ 50000 };       ///< of the open beam, a pixel
  double scatterToPrimary{ 0.6 };
  double scatterWidth{ 30.0 };   ///< mm at the detector
  double blur{ 0.5 };            ///< pixels
};

CTImage::Pointer
Smooth(const CTImage * image, double sigma)
{
  CTImage::Pointer result;
  for (unsigned int axis = 0; axis < 2; ++axis)
  {
    auto filter = itk::RecursiveGaussianImageFilter<CTImage, CTImage>::New();
    filter->SetInput(axis == 0 ? image : result.GetPointer());
    filter->SetDirection(axis);
    filter->SetSigma(sigma);
    filter->Update();
    result = filter->GetOutput();
    result->DisconnectPipeline();
  }
  return result;
}

/** Line integrals as a detector sees them: scatter, blur, photons, logarithm. */
RadiographView
Simulate(const CTImage * ct, const XRayGeometry::View & view, const XRaySimulation & simulation, std::mt19937_64 & random)
{
  auto attenuation = AttenuationImageFilter<CTImage, CTImage>::New();
  attenuation->SetInput(ct);
  attenuation->SetHUToAttenuation(HUToAttenuation::Bilinear);
  auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  auto drr = VoxelDRRImageFilter<CTImage, CTImage>::New();
  drr->SetInput(attenuation->GetOutput());
  drr->SetGeometry(geometry);
  drr->Update();
  CTImage::Pointer primary = drr->GetOutput();
  const auto       pixels = primary->GetBufferedRegion().GetNumberOfPixels();
  float *          p = primary->GetBufferPointer();
  for (std::size_t i = 0; i < pixels; ++i)
  {
    p[i] = static_cast<float>(simulation.photons * std::exp(-p[i]));
  }
  const auto     scatter = Smooth(primary, simulation.scatterWidth);
  const auto     sharp = Smooth(primary, simulation.blur * view.spacing[0]);
  RadiographView result;
  result.view = view;
  for (std::size_t i = 0; i < pixels; ++i)
  {
    const double mean = sharp->GetBufferPointer()[i] + simulation.scatterToPrimary * scatter->GetBufferPointer()[i];
    std::poisson_distribution<int> poisson(mean);
    const double                   seen = std::max(1, poisson(random));
    result.values.push_back(static_cast<float>(-std::log(seen / simulation.photons)));
  }
  return result;
}

/** A view of the model's box along a direction turned by `angle` degrees about z from the front, with some room. */
XRayGeometry::View
MakeView(const MeshArrays & mesh, double angle, int pixels)
{
  Vector3 lower = Vector3::Constant(1e30), upper = Vector3::Constant(-1e30);
  for (const Vector3 & x : mesh.points)
  {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const Vector3 room = 0.1 * (upper - lower);
  const double  turn = angle * std::acos(-1.0) / 180.0;
  auto view = XRayGeometry::Framing(
    lower - room, upper + room, { std::sin(turn), std::cos(turn), 0 }, { 0, 0, 1 }, 700, 1000, pixels);
  // A square detector about the same centre.
  const Vector3 centre = view.detectorOrigin + 0.5 * (view.size[0] - 1) * view.spacing[0] * view.detectorU +
                         0.5 * (view.size[1] - 1) * view.spacing[1] * view.detectorV;
  view.size = { { pixels, pixels } };
  view.detectorOrigin =
    centre - 0.5 * (pixels - 1) * (view.spacing[0] * view.detectorU + view.spacing[1] * view.detectorV);
  return view;
}
} // namespace

int
main(int argc, char * argv[])
{
  CLI::App            app("Rigid registration from many starts");
  std::string         ctPath, modelPath;
  std::vector<double> angles{ 0, 90 };
  int                 count = 10, pixels = 256, threads = 2;
  double              translation = 20, rotation = 20;
  std::uint64_t       seed = 1;
  XRaySimulation      simulation;
  std::string         picture;
  int                 pad = 0;
  RigidRadiographParameters parameters;
  bool                local = false;
  app.add_option("ct", ctPath)->required();
  app.add_option("model", modelPath)->required();
  app.add_option("--angles", angles);
  app.add_option("--count", count);
  app.add_option("--pixels", pixels);
  app.add_option("--threads", threads);
  app.add_option("--translation", translation);
  app.add_option("--rotation", rotation);
  app.add_option("--seed", seed);
  app.add_option("--spr", simulation.scatterToPrimary);
  app.add_option("--photons", simulation.photons);
  app.add_option("--patch", parameters.patch);
  app.add_option("--sigma", parameters.sigma);
  app.add_option("--population", parameters.population);
  app.add_option("--searches", parameters.searches);
  app.add_option("--search-pixels", parameters.searchPixels);
  app.add_option("--picture", picture);
  app.add_flag("--local", local);
  int only = -1;
  app.add_option("--only", only);
  app.add_option("--pad", pad);
  CLI11_PARSE(app, argc, argv);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(threads);

  CTImage::Pointer ct = ReadCT(ctPath);
  if (pad > 0)
  {
    auto padding = itk::ZeroFluxNeumannPadImageFilter<CTImage, CTImage>::New();
    padding->SetInput(ct);
    padding->SetPadBound(itk::Size<3>{ { static_cast<itk::SizeValueType>(pad), static_cast<itk::SizeValueType>(pad), static_cast<itk::SizeValueType>(pad) } });
    padding->Update();
    ct = padding->GetOutput();
  }
  const auto              hierarchy = ReadHierarchy(modelPath);
  std::vector<MeshArrays> levels;
  for (std::size_t i = 0; i < hierarchy->GetNumberOfLevels(); ++i)
  {
    levels.push_back(hierarchy->GetMesh(i)->GetArrays());
  }
  std::mt19937_64             random(seed);
  std::vector<RadiographView> views;
  for (const double angle : angles)
  {
    views.push_back(Simulate(ct, MakeView(levels.front(), angle, pixels), simulation, random));
  }
  if (!picture.empty())
  {
    for (std::size_t v = 0; v < views.size(); ++v)
    {
      auto image = itk::Image<float, 2>::New();
      image->SetRegions(itk::Size<2>{ { static_cast<itk::SizeValueType>(pixels), static_cast<itk::SizeValueType>(pixels) } });
      image->Allocate();
      std::copy(views[v].values.begin(), views[v].values.end(), image->GetBufferPointer());
      WriteImage(image.GetPointer(), picture + std::to_string(v) + ".mha");
    }
  }
  if (local)
  {
    parameters.searchTranslation = parameters.searchRotation = 0;
  }
  else
  {
    parameters.searchTranslation = translation;
    parameters.searchRotation = rotation;
  }
  RigidPose truth;
  truth.centre = [&] { Vector3 sum = Vector3::Zero(); for (const Vector3 & x : levels.front().points) { sum += x; } return Vector3(sum / static_cast<double>(levels.front().points.size())); }();
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double                           degree = std::acos(-1.0) / 180.0;
  for (int i = 0; i < count; ++i)
  {
    auto                   transform = itk::Euler3DTransform<double>::New();
    itk::Point<double, 3>  centre(truth.centre.data());
    itk::Vector<double, 3> shift;
    for (int k = 0; k < 3; ++k)
    {
      shift[k] = translation * uniform(random);
    }
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    transform->SetCenter(centre);
    transform->SetRotation(rotation * degree * x, rotation * degree * y, rotation * degree * z);
    transform->SetTranslation(shift);
    const RigidPose start = RigidPose::FromTransform(*transform);
    if (only >= 0 && i != only)
    {
      continue;
    }
  
    const auto clock = std::chrono::steady_clock::now();
    const std::clock_t ticks = std::clock();
    const auto result = RegisterRigid(levels, views, start, parameters, Execution());
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
    double before = 0, after = 0, plane = 0;
    Vector3 depth = (views.front().view.detectorU.cross(views.front().view.detectorV)).normalized();
    const double n = static_cast<double>(levels.front().points.size());
    for (const Vector3 & p : levels.front().points)
    {
      const Vector3 d = result.pose.Apply(p) - p;
      before += (start.Apply(p) - p).norm() / n;
      after += d.norm() / n;
      plane += (d - depth.dot(d) * depth).norm() / n;
    }
    std::cout << i << ' ' << before << ' ' << after << ' ' << plane << ' ' << result.cost << ' ' << result.converged << ' '
              << static_cast<int>(result.quality) << ' ' << seconds << ' ' << static_cast<double>(std::clock() - ticks) / CLOCKS_PER_SEC << ' ' << result.searches << ' '
              << result.pose.translation.transpose() << ' '
              << result.distinctness << ' ' << result.covariance.diagonal().cwiseSqrt().transpose() << std::endl;
  }
  return 0;
}
