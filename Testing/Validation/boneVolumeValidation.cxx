/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneVolumeValidation REGISTERED CTS SHAPES: leave-one-out over subjects NAME: trains an atlas of the others'
// REGISTERED/NAME.vtu, and finds the bone in a CT made of CTS/NAME.mha: a limb of soft tissue in air, neighbours that
// touch both ends, noise, turned and moved at random. Prints a JSON line a subject: distances to the surface
// SHAPES/NAME.ply (mm), what the registration says of itself, seconds.
#include "boneLeaveOneOut.h"

#include "boneVolumeRegistration.h"

#include "boneDensityRaster.h"
#include "boneImageIO.h"
#include "bonePointAlignment.h"
#include "boneTriangleDistance.h"

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <itkMultiThreaderBase.h>

#include <chrono>
#include <iostream>
#include <map>
#include <random>

namespace
{
using namespace bone;

struct Trials
{
  std::string              registered;
  std::string              cts;
  std::string              shapes;
  std::vector<std::string> only;
  std::uint64_t            seed{ 1 };
  double                   noise{ 20 };
  std::string              save;
  std::string              scan;
  std::string              labels;
  bool                     mirror{ false };
  AtlasVolumeParameters    parameters;
};

/** The neighbour of an end of the bone: a shell about it that touches it in places, HU; soft tissue elsewhere. */
double
Neighbour(const Vector3 & x, double distance, const std::vector<Vector3> & ends, double softTissue)
{
  constexpr double cortical = 900.0, trabecular = 300.0, radius = 32.0, plate = 2.5, depth = 14.0;
  for (const Vector3 & end : ends)
  {
    if ((x - end).norm() < radius)
    {
      const double gap = std::max(0.0, 1.2 + 1.2 * std::sin(x[0] / 6.0) * std::cos(x[1] / 5.0));
      const double within = std::clamp(distance - gap + 0.5, 0.0, 1.0);
      const double density =
        distance < gap + plate || (distance > depth && distance < depth + plate) ? cortical : trabecular;
      return distance < depth + plate ? softTissue + within * (density - softTissue) : softTissue;
    }
  }
  return softTissue;
}

/** In a limb, in air, with neighbours. */
CTImage::Pointer
Surround(const CTImage * bone, const TriangleSurface & surface, double noise, std::mt19937_64 & random)
{
  constexpr double   softTissue = 40.0, air = -1000.0, limb = 75.0, fat = 12.0, fatDensity = -90.0;
  CTImage::SizeType  size = bone->GetBufferedRegion().GetSize();
  auto               origin = bone->GetOrigin();
  std::array<int, 3> border{};
  for (unsigned int k = 0; k < 3; ++k)
  {
    border[k] = static_cast<int>((k == 0 ? 25.0 : 50.0) / bone->GetSpacing()[k]);
    origin[k] -= border[k] * bone->GetSpacing()[k];
    size[k] += static_cast<itk::SizeValueType>(2 * border[k]);
  }
  auto ct = CTImage::New();
  ct->SetRegions(size);
  ct->SetSpacing(bone->GetSpacing());
  ct->SetOrigin(origin);
  ct->Allocate();
  const auto                 order = [](const Vector3 & a, const Vector3 & b) { return a[0] < b[0]; };
  const std::vector<Vector3> ends{ *std::min_element(surface.points.begin(), surface.points.end(), order),
                                   *std::max_element(surface.points.begin(), surface.points.end(), order) };
  const TriangleDistance     distance(surface.points, surface.triangles);
  const VoxelGrid            grid = MakeVoxelGrid(*ct, ct->GetBufferedRegion());
  const Vector3              middle = grid.Centre(grid.size[0] / 2, grid.size[1] / 2, grid.size[2] / 2);
  const auto                 inner = bone->GetBufferedRegion().GetSize();
  std::vector<std::uint64_t> seeds(size[2]);
  std::generate(seeds.begin(), seeds.end(), random);
  Execution().For(size[2], [&](std::size_t k) {
    std::mt19937_64                  own(seeds[k]);
    std::normal_distribution<double> grain(0.0, noise);
    for (int j = 0; j < grid.size[1]; ++j)
    {
      for (int i = 0; i < grid.size[0]; ++i)
      {
        const Vector3 x = grid.Centre(i, j, static_cast<int>(k));
        const double  r = std::hypot(x[1] - middle[1], x[2] - middle[2]);
        double        value = r > limb + fat ? air : r > limb ? fatDensity : softTissue;
        const int     a = i - border[0], b = j - border[1], c = static_cast<int>(k) - border[2];
        const bool    near = std::min((x - ends[0]).norm(), (x - ends[1]).norm()) < 34.0;
        if (a >= 0 && b >= 0 && c >= 0 && a < static_cast<int>(inner[0]) && b < static_cast<int>(inner[1]) &&
            c < static_cast<int>(inner[2]))
        {
          const double of = static_cast<double>(bone->GetPixel({ { a, b, c } }));
          value = std::abs(of - softTissue) > 2.0 ? of : value;
        }
        if (near)
        {
          const double d = distance.FindNearest(x).distance;
          if (d > -1.0)
          {
            value = std::max(value, Neighbour(x, d, ends, softTissue));
          }
        }
        ct->SetPixel({ { i, j, static_cast<itk::IndexValueType>(k) } }, static_cast<float>(value + grain(own)));
      }
    }
  });
  return ct;
}

/** Turns and moves the CT; returns the motion of its points. */
AffineMap
MoveAtRandom(CTImage & ct, std::mt19937_64 & random)
{
  std::normal_distribution<double> normal;
  Eigen::Quaterniond               turn(normal(random), normal(random), normal(random), normal(random));
  turn.normalize();
  AffineMap motion{ turn.toRotationMatrix(), 100.0 * Vector3(normal(random), normal(random), normal(random)) };
  CTImage::DirectionType direction;
  const auto             old = ct.GetOrigin();
  const Vector3          origin = motion(Vector3(old[0], old[1], old[2]));
  auto                   moved = old;
  for (unsigned int r = 0; r < 3; ++r)
  {
    moved[r] = origin[r];
    for (unsigned int c = 0; c < 3; ++c)
    {
      direction(r, c) = motion.linear(r, c);
    }
  }
  ct.SetOrigin(moved);
  ct.SetDirection(direction);
  return motion;
}

/** The atlas of all subjects in a CT that was scanned, and how much what it found overlaps a label of its label map. */
void
RunScan(const Trials & trials, const StatisticalModelContent & atlas)
{
  const auto     ct = ReadCT(trials.scan);
  const auto     grid = MakeVoxelGrid(*ct, ct->GetBufferedRegion());
  const auto     clock = std::chrono::steady_clock::now();
  const auto     result = RegisterVolume(atlas, { grid, ct->GetBufferPointer() }, trials.parameters, Execution());
  nlohmann::json row{ { "scan", trials.scan }, { "mirrored", result.mirrored } };
  row["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
  row["quality"] = ParameterText(result.quality);
  row["supported"] = result.support.supported;
  row["visible"] = result.support.visible;
  row["residual"] = result.support.residual;
  row["settled"] = result.settled;
  row["repaired"] = result.repaired;
  row["inverted"] = result.inverted;
  row["correlation"] = result.correlation;
  row["coefficients"] = std::sqrt(result.coefficients.squaredNorm() / result.coefficients.size());
  if (!trials.labels.empty())
  {
    const auto            labels = ReadLabels(trials.labels);
    const DensityRaster   raster(result.mesh, grid);
    const std::size_t     slice = static_cast<std::size_t>(grid.size[0]) * grid.size[1];
    std::vector<double>   values(slice);
    std::vector<IdType>   cells(slice);
    std::map<int, double> both, all;
    double                inside = 0.0;
    for (int k = 0; k < grid.size[2]; ++k)
    {
      raster.FillSlice(k, -1e4, values.data(), cells.data());
      for (std::size_t i = 0; i < slice; ++i)
      {
        const int label = labels->GetBufferPointer()[static_cast<std::size_t>(k) * slice + i];
        all[label] += 1.0;
        both[label] += cells[i] >= 0 ? 1.0 : 0.0;
        inside += cells[i] >= 0 ? 1.0 : 0.0;
      }
    }
    for (const auto & [label, count] : all)
    {
      row["dice"][std::to_string(label)] = 2.0 * both[label] / (count + inside);
    }
  }
  if (!trials.save.empty())
  {
    WriteMeshArrays(result.mesh, trials.save + "/found.vtu");
  }
  std::cout << row << std::endl;
}

void
Run(const Trials & trials)
{
  const NamedSubjects subjects = ReadSubjects(trials.registered);
  if (!trials.scan.empty())
  {
    RunScan(trials, Train(subjects, ""));
    return;
  }
  std::uint64_t index = 0;
  for (const auto & [name, truth] : subjects)
  {
    std::mt19937_64 random(1000 * trials.seed + index++);
    if (!trials.only.empty() && std::find(trials.only.begin(), trials.only.end(), name) == trials.only.end())
    {
      continue;
    }
    const auto      atlas = Train(subjects, name);
    TriangleSurface surface = ReadTriangleSurface(trials.shapes + "/" + name + ".ply");
    const auto      ct = Surround(ReadCT(trials.cts + "/" + name + ".mha"), surface, trials.noise, random);
    double          lower = surface.points.front()[0], upper = lower;
    for (const Vector3 & x : surface.points)
    {
      lower = std::min(lower, x[0]);
      upper = std::max(upper, x[0]);
    }
    const AffineMap motion = MoveAtRandom(*ct, random);
    for (Vector3 & x : surface.points)
    {
      x = motion(x);
    }
    if (!trials.save.empty())
    {
      WriteImage(ct.GetPointer(), trials.save + "/" + name + ".mha");
    }
    const auto clock = std::chrono::steady_clock::now();
    const auto result = RegisterVolume(
      atlas, { MakeVoxelGrid(*ct, ct->GetBufferedRegion()), ct->GetBufferPointer() }, trials.parameters, Execution());
    if (!trials.save.empty())
    {
      WriteMeshArrays(result.mesh, trials.save + "/" + name + ".vtu");
    }
    nlohmann::json row{ { "subject", name } };
    row["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
    const Distances found = Compare(result.mesh, surface);
    row["found"] = found.mean;
    row["found95"] = found.most;
    std::size_t inverted = 0;
    for (const Id4 & t : result.mesh.tetrahedra)
    {
      const auto & x = result.mesh.points;
      inverted += SignedVolume(x[t[0]], x[t[1]], x[t[2]], x[t[3]]) > 0.0 ? 0 : 1;
    }
    row["inverted"] = inverted;
    // Along the bone, from end to end.
    const TriangleDistance distance(surface.points, surface.triangles);
    std::vector<double>    sums(10, 0.0), counts(10, 0.0);
    std::vector<IdType>    exterior;
    for (const Vector3 & x : ExteriorSurface(result.mesh, exterior).points)
    {
      const double along = motion.linear.col(0).dot(x - motion.translation);
      const auto   bin = static_cast<std::size_t>(std::clamp((along - lower) / (upper - lower) * 10.0, 0.0, 9.0));
      sums[bin] += std::abs(distance.FindNearest(x).distance);
      counts[bin] += 1.0;
    }
    for (std::size_t bin = 0; bin < sums.size(); ++bin)
    {
      row["along"].push_back(std::round(100.0 * sums[bin] / std::max(counts[bin], 1.0)) / 100.0);
    }
    // The registered model of the subject, in the CT's space, says where its points are.
    double inside = 0.0;
    for (std::size_t p = 0; p < truth.points.size(); ++p)
    {
      const Vector3 d = motion(truth.points[p]) - result.mesh.points[p];
      for (int k = 0; k < 3; ++k)
      {
        inside += std::abs(d[k]) < 1.96 * result.pointDeviations[p][k] ? 1.0 : 0.0;
      }
    }
    row["coverage"] = inside / (3.0 * static_cast<double>(truth.points.size()));
    row["volume"] = { result.regions.back().volume, result.regions.back().volumeDeviation, EnclosedVolume(surface) };
    row["supported"] = result.support.supported;
    row["visible"] = result.support.visible;
    row["residual"] = result.support.residual;
    row["correlation"] = result.correlation;
    row["coefficients"] = std::sqrt(result.coefficients.squaredNorm() / result.coefficients.size());
    row["quality"] = ParameterText(result.quality);
    row["settled"] = result.settled;
    row["repaired"] = result.repaired;
    row["largest"] = result.coefficients.cwiseAbs().maxCoeff();
    std::cout << row << std::endl;
  }
}
} // namespace

int
main(int argc, char * argv[])
{
  Trials   trials;
  CLI::App app("An atlas' bone in simulated CTs, leave-one-out");
  app.add_option("registered", trials.registered)->required();
  app.add_option("cts", trials.cts)->required();
  app.add_option("shapes", trials.shapes)->required();
  app.add_option("--only", trials.only, "Subjects");
  app.add_option("--seed", trials.seed);
  app.add_option("--noise", trials.noise, "Standard deviation, HU");
  app.add_option("--save", trials.save, "Folder to write the CTs into");
  app.add_option("--scan", trials.scan, "A CT, in place of simulated ones");
  app.add_option("--labels", trials.labels, "Its label map");
  app.add_flag("--mirror", trials.mirror);
  app.add_option("--search-seed", trials.parameters.seed);
  app.add_option("--smooth-modes", trials.parameters.smoothModes);
  app.add_option("--smooth-length", trials.parameters.smoothLength);
  app.add_option("--hypotheses", trials.parameters.hypotheses);
  CLI11_PARSE(app, argc, argv);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(2);
  trials.parameters.mirror = trials.mirror ? MirrorMode::Always : MirrorMode::Never;
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
