/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneRegistrationValidation CT MODEL.hierarchy.json...: registers models to X-rays simulated from the whole CT that
// they were built of, from many starts, and prints a JSON line a start: mTRE before and after, the part of it in the
// first view's plane (mm), cost, distinctness, quality (0 ok), seconds by the clock and of the processors, searches,
// the error of the translation and its standard deviations (mm), and the same of the other models. mTRE: mean
// displacement of the first level's points.
#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen

#include "boneHierarchyIO.h"
#include "boneImageIO.h"
#include "boneRayCastRegistration.h"
#include "boneRigidRegistration.h"
#include "boneXRaySimulation.h"

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <itkEuler3DTransform.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <iostream>
#include <iterator>
#include <random>

namespace
{
using namespace bone;

struct Trials
{
  std::string               ct;
  std::vector<std::string>  models;
  std::vector<double>       angles{ 0, 90 };
  int                       count{ 10 };
  int                       pixels{ 256 };
  double                    translation{ 20 };
  double                    rotation{ 20 };
  double                    mtre{ 0 };
  int                       axis{ 2 };
  double                    share{ 1 };
  std::array<double, 2>     viewError{}; // mm, degrees
  bool                      alone{ false };
  int                       rayCasting{ 0 };
  double                    threshold{ 0 };
  std::uint64_t             seed{ 1 };
  XRaySimulation            simulation;
  RigidRadiographParameters parameters;
};

/** The identity, moved by so much along (mm) and about (degrees) each axis. */
RigidPose
PoseAt(const Vector3 & centre, const Vector3 & shift, const Vector3 & turn)
{
  const Vector3 radians = std::acos(-1.0) / 180.0 * turn;
  auto          transform = itk::Euler3DTransform<double>::New();
  transform->SetCenter(itk::Point<double, 3>(centre.data()));
  transform->SetRotation(radians.x(), radians.y(), radians.z());
  transform->SetTranslation(itk::Vector<double, 3>(shift.data()));
  return RigidPose::FromTransform(*transform);
}

/** Mean displacement of the points. */
double
DisplacementOf(const std::vector<Vector3> & points, const RigidPose & pose)
{
  double sum = 0.0;
  for (const Vector3 & x : points)
  {
    sum += (pose.Apply(x) - x).norm();
  }
  return sum / static_cast<double>(points.size());
}

/** A pose that is off by up to so much along and about each axis; where an mTRE is given, that pose's motion times what
 * makes the mTRE uniform from 0 to it (E. B. van de Kraats et al., IEEE Trans Med Imaging 2005). */
RigidPose
DrawStart(const Trials & trials, const std::vector<Vector3> & points, const Vector3 & centre, std::mt19937_64 & random)
{
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Vector3                                shift, turn;
  for (int k = 0; k < 3; ++k)
  {
    shift[k] = trials.translation * unit(random);
    turn[k] = trials.rotation * unit(random);
  }
  if (!(trials.mtre > 0.0))
  {
    return PoseAt(centre, shift, turn);
  }
  const double wanted = trials.mtre * 0.5 * (1.0 + unit(random));
  double       factor = 1.0;
  for (int i = 0; i < 20; ++i) // all but linear
  {
    factor *= wanted / DisplacementOf(points, PoseAt(centre, factor * shift, factor * turn));
  }
  return PoseAt(centre, factor * shift, factor * turn);
}

/** The view moved by so many mm in some direction and so many degrees about some axis through `centre`. */
XRayGeometry::View
Misplace(const XRayGeometry::View &    view,
         const std::array<double, 2> & error,
         const Vector3 &               centre,
         std::mt19937_64 &             random)
{
  std::normal_distribution<double> normal;
  Vector3                          along, about;
  for (int k = 0; k < 3; ++k)
  {
    along[k] = normal(random);
    about[k] = normal(random);
  }
  const double    radians = error[1] * std::acos(-1.0) / 180.0;
  const RigidPose motion{ Eigen::AngleAxisd(radians, about.normalized()).toRotationMatrix(),
                          error[0] * along.normalized(),
                          centre };
  return motion.ToModelSpace(view);
}

std::vector<MeshArrays>
ReadLevels(const std::string & path)
{
  const auto              hierarchy = ReadHierarchy(path);
  std::vector<MeshArrays> levels;
  for (std::size_t i = 0; i < hierarchy->GetNumberOfLevels(); ++i)
  {
    levels.push_back(hierarchy->GetMesh(i)->GetArrays());
  }
  return levels;
}

/** What came of a body whose true pose is the identity; `depth`: along the first view's axis. */
nlohmann::json
Describe(const RigidRegistrationResult & result, const std::vector<Vector3> & points, const Vector3 & depth)
{
  double plane = 0.0;
  for (const Vector3 & x : points)
  {
    const Vector3 d = result.pose.Apply(x) - x;
    plane += (d - depth.dot(d) * depth).norm() / static_cast<double>(points.size());
  }
  nlohmann::json row{ { "after", DisplacementOf(points, result.pose) },
                      { "plane", plane },
                      { "cost", result.cost },
                      { "distinctness", result.distinctness },
                      { "leastDistinctness", result.leastDistinctness },
                      { "quality", static_cast<int>(result.quality) },
                      { "searches", result.searches } };
  const Vector3  deviations = result.covariance.diagonal().head<3>().cwiseSqrt();
  for (int k = 0; k < 3; ++k)
  {
    row["translation"].push_back(result.pose.translation[k]);
    row["deviation"].push_back(deviations[k]);
  }
  return row;
}

/** Those of the points in a share of their extent along an axis, from its end of the largest coordinate. */
std::vector<Vector3>
TakeShare(const std::vector<Vector3> & points, int axis, double share)
{
  const auto [low, high] = std::minmax_element(
    points.begin(), points.end(), [axis](const Vector3 & a, const Vector3 & b) { return a[axis] < b[axis]; });
  const double         least = (*high)[axis] - share * ((*high)[axis] - (*low)[axis]);
  std::vector<Vector3> taken;
  std::copy_if(points.begin(), points.end(), std::back_inserter(taken), [axis, least, share](const Vector3 & x) {
    return share >= 1.0 || x[axis] >= least;
  });
  return taken;
}

std::vector<RigidRegistrationResult>
Register(const Trials &                               trials,
         const CTImage *                              ct,
         const std::vector<std::vector<MeshArrays>> & models,
         const std::vector<RadiographView> &          views,
         const RigidPose &                            start)
{
  if (trials.rayCasting > 0)
  {
    RigidRegistrationResult result;
    result.pose = RegisterByRayCasting(ct, views, start, trials.rayCasting, trials.threshold);
    return { result };
  }
  if (trials.alone)
  {
    std::vector<RigidRegistrationResult> results;
    for (const auto & levels : models)
    {
      results.push_back(RegisterRigid(levels, views, start, trials.parameters, Execution()));
    }
    return results;
  }
  return RegisterRigidBodies(models, views, start, trials.parameters, Execution()).bodies;
}

void
Run(const Trials & trials)
{
  const auto                           ct = ReadCT(trials.ct);
  std::vector<std::vector<MeshArrays>> models;
  std::vector<Vector3>                 all;
  for (const std::string & path : trials.models)
  {
    models.push_back(ReadLevels(path));
    const auto shown = TakeShare(models.back().front().points, trials.axis, trials.share);
    all.insert(all.end(), shown.begin(), shown.end());
  }
  const auto points = TakeShare(models.front().front().points, trials.axis, trials.share);
  Vector3    centre = Vector3::Zero();
  for (const Vector3 & x : points)
  {
    centre += x / static_cast<double>(points.size());
  }
  std::mt19937_64             random(trials.seed);
  std::vector<RadiographView> views;
  for (const double angle : trials.angles)
  {
    const auto view = MakeView(all, Vector3::UnitY(), Vector3::Unit(trials.axis), angle, trials.pixels);
    views.push_back(Simulate(ct, view, trials.simulation, random));
  }
  const Vector3 depth = views.front().view.detectorU.cross(views.front().view.detectorV).normalized();
  const std::vector<RadiographView> right = views;
  for (int i = 0; i < trials.count; ++i)
  {
    const RigidPose start = DrawStart(trials, points, centre, random);
    for (std::size_t v = 1; v < views.size(); ++v)
    {
      views[v].view = Misplace(right[v].view, trials.viewError, centre, random);
    }
    const auto         clock = std::chrono::steady_clock::now();
    const std::clock_t ticks = std::clock();
    const auto         results = Register(trials, ct, models, views, start);
    const double       seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
    auto               row = Describe(results.front(), points, depth);
    row["seconds"] = seconds;
    row["processor"] = static_cast<double>(std::clock() - ticks) / CLOCKS_PER_SEC;
    row["before"] = DisplacementOf(points, start);
    for (std::size_t b = 1; b < results.size(); ++b)
    {
      row["others"].push_back(Describe(results[b], models[b].front().points, depth));
    }
    std::cout << row << std::endl;
  }
}
} // namespace

int
main(int argc, char * argv[])
{
  Trials   trials;
  CLI::App app("Rigid registration to simulated X-rays from many starts");
  app.add_option("ct", trials.ct)->required();
  app.add_option("models", trials.models, "Several: registered together")->required();
  app.add_option("--angles", trials.angles, "Of the views about the upright axis from the front, degrees");
  app.add_option("--axis", trials.axis, "Upright in the X-rays: 0 (x) or 2 (z)");
  app.add_option(
    "--share", trials.share, "Of the models' extent along it, from above, which X-rays, starts and errors are of");
  app.add_option("--count", trials.count, "Starts");
  app.add_option("--pixels", trials.pixels, "Of a side of the X-rays");
  app.add_option("--translation", trials.translation, "Starts are off by up to so many mm along each axis");
  app.add_option("--rotation", trials.rotation, "and so many degrees about each");
  app.add_flag("--alone", trials.alone, "Each model by itself");
  app.add_option(
    "--ray-casting", trials.rayCasting, "Pixels of a side of the CT's own radiographs: RegisterByRayCasting");
  app.add_option("--threshold", trials.threshold, "Of those, HU");
  app.add_option("--mtre", trials.mtre, "Starts are off by up to this mTRE (mm) in place of that");
  app.add_option(
    "--view-error", trials.viewError, "How far views after the first are from where they are said to be: mm, degrees");
  app.add_option("--view-translation-deviation", trials.parameters.viewTranslationDeviation);
  app.add_option("--view-rotation-deviation", trials.parameters.viewRotationDeviation);
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
