/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneRegistrationValidation CT MODEL.hierarchy.json: registers a model to X-rays simulated from the whole CT that it
// was built of, from many starts, and prints a line a start: number, mTRE before and after, the part of it in the first
// view's plane (mm), cost, distinctness, quality (0 ok), seconds by the clock and of the processors, searches, the
// error of the translation and its standard deviations (mm). mTRE: mean displacement of the first level's points.
#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen

#include "boneHierarchyIO.h"
#include "boneImageIO.h"
#include "boneRigidRegistration.h"
#include "boneXRaySimulation.h"

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <itkEuler3DTransform.h>

#include <chrono>
#include <ctime>
#include <iostream>
#include <random>

namespace
{
using namespace bone;

struct Trials
{
  std::string               ct;
  std::string               model;
  std::vector<double>       angles{ 0, 90 };
  int                       count{ 10 };
  int                       pixels{ 256 };
  double                    translation{ 20 };
  double                    rotation{ 20 };
  std::uint64_t             seed{ 1 };
  XRaySimulation            simulation;
  RigidRadiographParameters parameters;
};

/** A pose that is off by up to so much along and about each axis. */
RigidPose
DrawStart(const Trials & trials, const Vector3 & centre, std::mt19937_64 & random)
{
  std::uniform_real_distribution<double> shift(-trials.translation, trials.translation);
  std::uniform_real_distribution<double> turn(-trials.rotation, trials.rotation);
  const double                           degree = std::acos(-1.0) / 180.0;
  auto                                   transform = itk::Euler3DTransform<double>::New();
  itk::Vector<double, 3>                 translation;
  std::array<double, 3>                  angles{};
  for (unsigned int k = 0; k < 3; ++k)
  {
    translation[k] = shift(random);
    angles[k] = degree * turn(random);
  }
  transform->SetCenter(itk::Point<double, 3>(centre.data()));
  transform->SetRotation(angles[0], angles[1], angles[2]);
  transform->SetTranslation(translation);
  return RigidPose::FromTransform(*transform);
}

void
Run(const Trials & trials)
{
  const auto              ct = ReadCT(trials.ct);
  const auto              hierarchy = ReadHierarchy(trials.model);
  std::vector<MeshArrays> levels;
  for (std::size_t i = 0; i < hierarchy->GetNumberOfLevels(); ++i)
  {
    levels.push_back(hierarchy->GetMesh(i)->GetArrays());
  }
  const auto & points = levels.front().points;
  const double share = 1.0 / static_cast<double>(points.size());
  Vector3      centre = Vector3::Zero();
  for (const Vector3 & x : points)
  {
    centre += share * x;
  }
  std::mt19937_64             random(trials.seed);
  std::vector<RadiographView> views;
  for (const double angle : trials.angles)
  {
    views.push_back(Simulate(ct,
                             MakeView(levels.front().points, Vector3::UnitY(), Vector3::UnitZ(), angle, trials.pixels),
                             trials.simulation,
                             random));
  }
  const Vector3 depth = views.front().view.detectorU.cross(views.front().view.detectorV).normalized();
  for (int i = 0; i < trials.count; ++i)
  {
    const RigidPose    start = DrawStart(trials, centre, random);
    const auto         clock = std::chrono::steady_clock::now();
    const std::clock_t ticks = std::clock();
    const auto         result = RegisterRigid(levels, views, start, trials.parameters, Execution());
    const double       seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
    const double       processor = static_cast<double>(std::clock() - ticks) / CLOCKS_PER_SEC;
    double             before = 0, after = 0, plane = 0;
    for (const Vector3 & x : points)
    {
      const Vector3 d = result.pose.Apply(x) - x;
      before += share * (start.Apply(x) - x).norm();
      after += share * d.norm();
      plane += share * (d - depth.dot(d) * depth).norm();
    }
    std::cout << i << ' ' << before << ' ' << after << ' ' << plane << ' ' << result.cost << ' ' << result.distinctness
              << ' ' << static_cast<int>(result.quality) << ' ' << seconds << ' ' << processor << ' ' << result.searches
              << ' ' << result.pose.translation.transpose() << ' '
              << result.covariance.diagonal().head<3>().cwiseSqrt().transpose() << std::endl;
  }
}
} // namespace

int
main(int argc, char * argv[])
{
  Trials   trials;
  CLI::App app("Rigid registration to simulated X-rays from many starts");
  app.add_option("ct", trials.ct)->required();
  app.add_option("model", trials.model)->required();
  app.add_option("--angles", trials.angles, "Of the views about z from the front, degrees");
  app.add_option("--count", trials.count, "Starts");
  app.add_option("--pixels", trials.pixels, "Of a side of the X-rays");
  app.add_option("--translation", trials.translation, "Starts are off by up to so many mm along each axis");
  app.add_option("--rotation", trials.rotation, "and so many degrees about each");
  app.add_option("--seed", trials.seed);
  app.add_option("--scatter", trials.simulation.scatterToPrimary, "Scatter-to-primary ratio");
  app.add_option("--photons", trials.simulation.photons, "Of the open beam, a pixel");
  app.add_option("--patch", trials.parameters.patch);
  app.add_option("--searches", trials.parameters.searches, "0: refinement from the start alone");
  app.add_option("--search-pixels", trials.parameters.searchPixels);
  app.add_option("--cut-length", trials.parameters.cutLength);
  CLI11_PARSE(app, argc, argv);
  const bool search = trials.parameters.searches > 0;
  trials.parameters.searches = std::max(1, trials.parameters.searches);
  trials.parameters.searchTranslation = search ? trials.translation : 0.0;
  trials.parameters.searchRotation = search ? trials.rotation : 0.0;
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(2);
  try
  {
    Run(trials);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
