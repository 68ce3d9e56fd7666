/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Cortical thickness measured on CTs of phantoms against the phantoms' own: what thickness.py makes its tables of.
// Writes a JSON list to standard output, an object for each seed of the noise.
//
//   boneThicknessValidation BONE MESH.vtu name=value ...
//
// BONE: the name of a phantom, or the outer surface of one (.ply) whose cortex is of one density; MESH.vtu: a mesh of
// it. Names: thickness and shaft (mm, of a surface's cortex at the ends and in the shaft; default alike), spacing,
// slices (mm between slices), blur (full width at half maximum, mm), noise (HU), seeds (how many); density:
// the cortex's in HU, 0: to be estimated; spread: 1 where the blur is given; lower, upper: only points whose true
// thickness lies between count.

#include "boneCorticalProfile.h"
#include "boneCorticalThicknessFilter.h"
#include "boneImageIO.h"
#include "boneLinearSampler.h"
#include "boneMakePhantom.h"
#include "boneMeshIO.h"
#include "bonePhantomImageSource.h"
#include "boneSurfacePhantom.h"

#include <itkImageDuplicator.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <random>

namespace
{
using namespace bone;
using Json = nlohmann::ordered_json;
using Options = std::map<std::string, double>;

double
Number(const Options & options, const std::string & name, double otherwise)
{
  const auto found = options.find(name);
  return found == options.end() ? otherwise : found->second;
}

PhantomModel::Pointer
MakeBone(const std::string & name, const Options & options)
{
  const auto & names = PhantomNames();
  if (std::find(names.begin(), names.end(), name) != names.end())
  {
    return MakePhantom(name, 0);
  }
  const TriangleSurface                   surface = ReadTriangleSurface(name);
  std::vector<TriangleDistance::Triangle> triangles(surface.triangles.begin(), surface.triangles.end());
  SurfacePhantomParameters                parameters;
  parameters.endCortex = Number(options, "thickness", 1.0);
  parameters.shaftCortex = Number(options, "shaft", parameters.endCortex);
  parameters.endDensity = parameters.shaftDensity = Number(options, "true", 1600.0);
  parameters.medullaryCavity = false;
  return std::make_shared<const SurfacePhantom>(surface.points, triangles, parameters);
}

CTImage::Pointer
MakeCT(PhantomModel::Pointer bone, const Options & options)
{
  using Source = PhantomImageSource<CTImage>;
  auto                source = Source::New();
  Source::SpacingType spacing, spread;
  spacing.Fill(Number(options, "spacing", 1.0));
  spacing[2] = Number(options, "slices", spacing[0]);
  spread.Fill(Number(options, "blur", 1.0));
  source->SetModel(std::move(bone));
  source->SetSpacing(spacing);
  source->SetPointSpread(spread);
  source->Update();
  return source->GetOutput();
}

/** The phantom's own thickness below each point; NaN where it does not count. */
std::vector<double>
TrueThickness(const PhantomModel & bone, const CorticalThicknessMap & map, const Options & options)
{
  const double        lower = Number(options, "lower", 0.0), upper = Number(options, "upper", 1e9);
  std::vector<double> thickness;
  for (const Vector3 & p : map.surface.points)
  {
    const double truth = bone.CorticalThickness(p);
    thickness.push_back(truth >= lower && truth < upper ? truth : std::nan(""));
  }
  return thickness;
}

/** Errors of what was measured. */
Json
Compare(const std::vector<double> & values, const std::vector<double> & truth)
{
  std::vector<double> errors;
  double              points = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t p = 0; p < values.size(); ++p)
  {
    points += std::isfinite(truth[p]) ? 1.0 : 0.0;
    if (std::isfinite(values[p]) && std::isfinite(truth[p]))
    {
      const double error = values[p] - truth[p];
      errors.push_back(error);
      sum += error;
      squares += error * error;
    }
  }
  const auto count = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  Json json{ { "points", points }, { "found", count }, { "sum", sum }, { "squares", squares } };
  json["percentile95"] = errors.empty() ? 0.0 : std::abs(errors[static_cast<std::size_t>(0.95 * (count - 1.0))]);
  return json;
}

/** The half-maximum rule on the line along each point's normal in the linearly interpolated CT, as FindCorticalEdges
 * has it; with `blur`, a standard deviation, freed of it by ThicknessOfBlurredLayer. */
std::vector<double>
HalfMaximum(const CorticalThicknessMap & map, const CTImage & ct, double blur)
{
  const VoxelGrid            grid = MakeVoxelGrid(ct, ct.GetBufferedRegion());
  const LinearSampler<float> sampler(ct.GetBufferPointer(), grid.size);
  const Eigen::Matrix3d      toIndex = grid.axes.inverse();
  const auto                 normals = PointNormals(map.surface);
  CorticalRules              rules;
  rules.pixel = grid.axes.colwise().norm().maxCoeff();
  std::vector<double> values;
  for (std::size_t p = 0; p < normals.size(); ++p)
  {
    CorticalProfile profile;
    profile.step = 0.1;
    profile.lead = 30;
    for (int k = -profile.lead; k < 100; ++k)
    {
      const Vector3 x = map.surface.points[p] - k * profile.step * normals[p];
      profile.values.push_back(sampler(toIndex * (x - grid.origin)));
    }
    const CorticalEdges edges = FindCorticalEdges(profile, rules);
    values.push_back(edges.kind == CorticalEdges::Kind::Found ? ThicknessOfBlurredLayer(edges.inner - edges.outer, blur)
                                                              : std::nan(""));
  }
  return values;
}

CTImage::Pointer
AddNoise(const CTImage * clean, double deviation, unsigned int seed)
{
  auto duplicator = itk::ImageDuplicator<CTImage>::New();
  duplicator->SetInputImage(clean);
  duplicator->Update();
  CTImage::Pointer                 ct = duplicator->GetOutput();
  std::mt19937_64                  random(seed);
  std::normal_distribution<double> normal(0.0, deviation);
  for (std::size_t v = 0; v < ct->GetBufferedRegion().GetNumberOfPixels(); ++v)
  {
    ct->GetBufferPointer()[v] += static_cast<float>(normal(random));
  }
  return ct;
}

/** What the filter and the half-maximum rule find in one CT. */
Json
Measure(CorticalThicknessFilter<CTImage> & filter,
        const PhantomModel &               phantom,
        const CTImage &                    ct,
        const Options &                    options)
{
  const auto begin = std::chrono::steady_clock::now();
  filter.Update();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const CorticalThicknessMap & map = filter.GetMap();
  const auto                   truth = TrueThickness(phantom, map, options);
  const double                 blur = Number(options, "blur", 1.0) / 2.3548200450309493;
  Json                         json{ { "seconds", seconds } };
  json["fit"] = Compare(map.thickness, truth);
  json["half"] = Compare(HalfMaximum(map, ct, 0.0), truth);
  json["freed"] = Compare(HalfMaximum(map, ct, blur), truth);
  json["report"] = ReportThickness(map);
  json["raw"] = Compare(map.fitted, truth);
  return json;
}
} // namespace

int
main(int argc, char ** argv)
{
  if (argc < 3)
  {
    std::cerr << "boneThicknessValidation BONE MESH.vtu name=value ...\n";
    return 2;
  }
  try
  {
    Options options;
    for (int i = 3; i < argc; ++i)
    {
      const std::string text = argv[i];
      const auto        equals = text.find('=');
      options[text.substr(0, equals)] = std::stod(text.substr(equals + 1));
    }
    const auto phantom = MakeBone(argv[1], options);
    const auto clean = MakeCT(phantom, options);
    auto       filter = CorticalThicknessFilter<CTImage>::New();
    filter->SetMesh(ReadDensityMesh(argv[2]));
    filter->SetCorticalDensity(Number(options, "density", 0.0));
    filter->SetPointSpread(Number(options, "spread", 0.0) > 0.0 ? Number(options, "blur", 1.0) : 0.0);
    Json runs;
    for (int seed = 1; seed <= static_cast<int>(Number(options, "seeds", 1.0)); ++seed)
    {
      const auto ct = AddNoise(clean, Number(options, "noise", 20.0), static_cast<unsigned int>(seed));
      filter->SetImage(ct);
      runs.push_back(Measure(*filter, *phantom, *ct, options));
    }
    std::cout << runs.dump() << '\n';
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
