/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneDeformableValidation REGISTERED CTS SHAPES: leave-one-out over subjects NAME: trains an atlas of the others'
// REGISTERED/NAME.vtu, simulates X-rays of CTS/NAME.mha, and finds shape and density from starts that are off. Prints a
// JSON line a subject: why it was refused, or distances to the surface SHAPES/NAME.ply (mm) of the mean, of the best
// projection on the atlas' modes, and of what was found; how many of the 95 % intervals hold the truth; seconds.
#include "boneLeaveOneOut.h"
#include "boneXRaySimulation.h"

#include "boneBernstein.h"
#include "boneDeformableRegistration.h"
#include "bonePointAlignment.h"

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <itkConstantPadImageFilter.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <ctime>
#include <iostream>
#include <limits>
#include <numeric>

namespace
{
using namespace bone;

struct Trials
{
  std::string                    registered;
  std::string                    cts;
  std::string                    shapes;
  std::vector<std::string>       only;
  std::vector<double>            angles{ 0, 90 };
  int                            pixels{ 256 };
  double                         room{ 0.1 };
  double                         share{ 1 };
  double                         translation{ 10 };
  double                         rotation{ 10 };
  std::uint64_t                  seed{ 1 };
  bool                           trace{ false };
  XRaySimulation                 simulation;
  DeformableRadiographParameters parameters;
};

/** With soft tissue about it, as far as its air is dark. */
CTImage::Pointer
Embed(const CTImage * ct, double softTissue)
{
  auto              pad = itk::ConstantPadImageFilter<CTImage, CTImage>::New();
  CTImage::SizeType border;
  for (unsigned int k = 0; k < 3; ++k)
  {
    border[k] = static_cast<itk::SizeValueType>(40.0 / ct->GetSpacing()[k]);
  }
  pad->SetInput(ct);
  pad->SetPadBound(border);
  pad->SetConstant(static_cast<float>(softTissue));
  pad->Update();
  return pad->GetOutput();
}

RigidPose
Disturb(const RigidPose & pose, const Trials & trials, std::mt19937_64 & random)
{
  std::uniform_real_distribution<double> shift(-trials.translation, trials.translation);
  std::uniform_real_distribution<double> turn(-trials.rotation, trials.rotation);
  Eigen::Matrix<double, 6, 1>            step;
  for (int k = 0; k < 3; ++k)
  {
    step[k] = shift(random);
    step[3 + k] = turn(random) * std::acos(-1.0) / 180.0;
  }
  return pose.Moved(step);
}

/** x of the end of a share of the bone from its proximal end, which has the largest x; of all of it, none. */
double
LeastShown(const std::vector<Vector3> & points, double share)
{
  const auto [low, high] = std::minmax_element(
    points.begin(), points.end(), [](const Vector3 & a, const Vector3 & b) { return a.x() < b.x(); });
  return share < 1.0 ? high->x() - share * (high->x() - low->x()) : std::numeric_limits<double>::lowest();
}

void
Run(const Trials & trials)
{
  const NamedSubjects subjects = ReadSubjects(trials.registered);
  std::uint64_t       index = 0;
  for (const auto & [name, truth] : subjects)
  {
    // Each subject has noise and a start of its own.
    std::mt19937_64 random(1000 * trials.seed + index++);
    if (!trials.only.empty() && std::find(trials.only.begin(), trials.only.end(), name) == trials.only.end())
    {
      continue;
    }
    const auto           atlas = Train(subjects, name);
    const auto           surface = ReadTriangleSurface(trials.shapes + "/" + name + ".ply");
    const auto           ct = Embed(ReadCT(trials.cts + "/" + name + ".mha"), 40.0);
    const double         from = LeastShown(truth.points, trials.share);
    std::vector<Vector3> shown, inMean;
    for (std::size_t p = 0; p < truth.points.size(); ++p)
    {
      if (truth.points[p].x() >= from)
      {
        shown.push_back(truth.points[p]);
        inMean.push_back(atlas.mean.points[p]);
      }
    }
    const AffineMap fit = FitAlignment(inMean, shown, AlignmentKind::Rigid);
    Vector3         centre = Vector3::Zero();
    for (const Vector3 & x : inMean)
    {
      centre += x / static_cast<double>(inMean.size());
    }
    const RigidPose right{ fit.linear, fit(centre) - centre, centre };

    nlohmann::json row{ { "subject", name } };
    const auto     put = [&row](const std::string & what, const Distances & d) {
      row[what] = d.mean;
      row[what + "95"] = d.most;
    };
    MeshArrays mesh = atlas.mean;
    for (Vector3 & x : mesh.points)
    {
      x = right.Apply(x);
    }
    put("meanShape", Compare(mesh, surface, from));
    std::vector<Vector3> inAtlas;
    const AffineMap      back = AlignToMean(truth.points, atlas.mean.points, AlignmentKind::Rigid);
    for (const Vector3 & x : truth.points)
    {
      inAtlas.push_back(back(x));
    }
    mesh.points = UnstackPoints(atlas.shape.Synthesize(atlas.shape.Project(StackPoints(inAtlas))));
    for (Vector3 & x : mesh.points)
    {
      x = back.Inverse()(x);
    }
    put("projection", Compare(mesh, surface, from));

    std::vector<RadiographView> views;
    for (const double angle : trials.angles)
    {
      views.push_back(Simulate(ct,
                               MakeView(shown, Vector3::UnitY(), Vector3::UnitX(), angle, trials.pixels, trials.room),
                               trials.simulation,
                               random));
    }
    const RigidPose              start = Disturb(right, trials, random);
    const auto                   clock = std::chrono::steady_clock::now();
    const auto                   used = std::clock();
    DeformableRegistrationResult result;
    try
    {
      result = RegisterDeformable(
        atlas, views, start, trials.parameters, Execution(), [&](const Eigen::VectorXd & c, double cost) {
          if (trials.trace)
          {
            std::cerr << cost << " |c|^2 " << c.squaredNorm() << " of " << c.size() << std::endl;
          }
        });
    }
    catch (const std::invalid_argument & error)
    {
      std::cout << nlohmann::json{ { "subject", name }, { "refused", error.what() } } << std::endl;
      continue;
    }
    row["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
    row["processorSeconds"] = static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC;
    put("found", Compare(result.mesh, surface, from));
    // Moved onto the truth: of the shape alone, as one view does not tell the depth.
    MeshArrays           aligned = result.mesh;
    std::vector<Vector3> found;
    for (std::size_t p = 0; p < truth.points.size(); ++p)
    {
      if (truth.points[p].x() >= from)
      {
        found.push_back(aligned.points[p]);
      }
    }
    const AffineMap onto = FitAlignment(found, shown, AlignmentKind::Rigid);
    for (Vector3 & x : aligned.points)
    {
      x = onto(x);
    }
    put("aligned", Compare(aligned, surface, from));
    row["quality"] = static_cast<int>(result.quality);
    row["distinctness"] = result.distinctness;
    double inside = 0.0, squares = 0.0, deviations = 0.0, points = 0.0;
    for (std::size_t p = 0; p < truth.points.size(); ++p)
    {
      if (truth.points[p].x() < from)
      {
        continue;
      }
      const Vector3 d = result.mesh.points[p] - truth.points[p];
      for (int k = 0; k < 3; ++k)
      {
        inside += std::abs(d[k]) < 1.96 * result.pointDeviations[p][k] ? 1.0 : 0.0;
        squares += d[k] * d[k];
        deviations += result.pointDeviations[p][k] * result.pointDeviations[p][k];
        points += 1.0;
      }
    }
    row["shape1"] = { result.coefficients[0], atlas.shape.Project(StackPoints(inAtlas))[0] };
    row["regions"] = nlohmann::json::array();
    const auto labels = ReadLabels(trials.cts + "/" + name + "_l.nii.gz");
    const auto scan = ReadCT(trials.cts + "/" + name + ".mha");
    for (const RegionEstimate & region : result.regions)
    {
      double volume = 0.0, mass = 0.0;
      for (std::size_t i = 0; i < labels->GetBufferedRegion().GetNumberOfPixels(); ++i)
      {
        const int label = labels->GetBufferPointer()[i];
        if (region.region < 0 ? label > 0 : label == region.region)
        {
          volume += 1.0;
          mass += scan->GetBufferPointer()[i];
        }
      }
      row["regions"].push_back({ { "region", region.region },
                                 { "volume", { region.volume, region.volumeDeviation, volume } },
                                 { "density", { region.density, region.densityDeviation, mass / volume } },
                                 { "mass", { region.mass, region.massDeviation, mass } } });
      // And what the registered model of the subject has.
      volume = mass = 0.0;
      for (std::size_t t = 0; t < truth.tetrahedra.size(); ++t)
      {
        if (region.region < 0 || truth.region[t] == region.region)
        {
          const auto & ids = truth.tetrahedra[t];
          const double v =
            SignedVolume(truth.points[ids[0]], truth.points[ids[1]], truth.points[ids[2]], truth.points[ids[3]]);
          const auto each = static_cast<std::size_t>(BernsteinCount(truth.maximumDegree));
          const auto first = truth.coefficients.begin() + static_cast<std::ptrdiff_t>(t * each);
          const int  number = BernsteinCount(truth.degree[t]);
          volume += v;
          mass += v * std::accumulate(first, first + number, 0.0) / number;
        }
      }
      auto & put3 = row["regions"].back();
      put3["volume"].push_back(volume);
      put3["density"].push_back(mass / volume);
      put3["mass"].push_back(mass);
    }
    row["coverage"] = inside / points;
    row["pointError"] = std::sqrt(squares / points);
    row["statedError"] = std::sqrt(deviations / points);
    row["cost"] = result.cost;
    row["intensityPrecision"] = result.intensityPrecision;
    row["precision"] = result.precision;
    row["converged"] = result.converged;
    std::cout << row << std::endl;
  }
}
} // namespace

int
main(int argc, char * argv[])
{
  Trials   trials;
  CLI::App app("Shape and density from simulated X-rays, leave-one-out");
  auto &   p = trials.parameters;
  app.add_option("registered", trials.registered)->required();
  app.add_option("cts", trials.cts)->required();
  app.add_option("shapes", trials.shapes)->required();
  app.add_option("--only", trials.only, "Subjects");
  app.add_option("--angles", trials.angles, "Of the views about the bone's axis, degrees");
  app.add_option("--pixels", trials.pixels, "Of a side of the X-rays");
  app.add_option("--room", trials.room, "On each side of the bone in the X-rays, of the box about it");
  app.add_option(
    "--share", trials.share, "Of the bone's length from its proximal end, which X-rays and distances are of");
  app.add_option("--translation", trials.translation, "Starts are off by up to so many mm along each axis");
  app.add_option("--rotation", trials.rotation, "and so many degrees about each");
  app.add_option("--seed", trials.seed);
  app.add_flag("--trace", trials.trace);
  app.add_option("--scatter", trials.simulation.scatterToPrimary, "Scatter-to-primary ratio");
  app.add_option("--blur", trials.simulation.blur, "Of the detector, pixels");
  app.add_option("--photons", trials.simulation.photons, "Of the open beam, a pixel");
  app.add_option("--smooth-modes", p.smoothModes);
  app.add_option("--smooth-deviation", p.smoothDeviation);
  app.add_option("--smooth-length", p.smoothLength);
  app.add_option("--density-modes", p.densityModes);
  app.add_option("--search-modes", p.searchModes);
  app.add_option("--population", p.population);
  app.add_option("--intensities", p.intensities);
  app.add_option("--background-length", p.backgroundLength);
  app.add_option("--gain-deviation", p.gainDeviation);
  app.add_option("--patch", p.patch);
  app.add_option("--sigma", p.sigma);
  app.add_option("--surface-deviation", p.surfaceDeviation);
  app.add_option("--iterations", p.iterations);
  app.add_option("--search-pixels", p.searchPixels);
  app.add_option("--target-pixels", p.pixels);
  app.add_option("--prior-translation", p.translationDeviation);
  app.add_option("--prior-rotation", p.rotationDeviation);
  CLI11_PARSE(app, argc, argv);
  p.searchTranslation = trials.translation;
  p.searchRotation = trials.rotation;
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
