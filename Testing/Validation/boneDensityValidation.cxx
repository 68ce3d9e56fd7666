/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Fits densities to one mesh and measures them: what density.py makes its tables of. Writes a JSON list to standard
// output, an entry for each degree.
//
//   boneDensityValidation MESH.vtu CT LABELS LABEL [name=value ...]
//
// Names: degrees=0,1,...; continuous, gradient (0 or 1: continuous gradient), interpolator (linear, bspline),
// voxelweight, tikhonov, limit, margin, maxerror: the fit's parameters; truth=IMAGE: an image to compare with in place
// of the CT; repeat=N: runs of which the fastest counts; joins=1: the jumps across faces within regions, and the error
// of the gradient.

#include "boneImageIO.h"
#include "boneMeshIO.h"

#include "boneDensityEvaluation.h"
#include "boneDensityFitFilter.h"
#include "boneDensityRaster.h"
#include "boneLinearSampler.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <sstream>

namespace
{
using namespace bone;
using Json = nlohmann::ordered_json;
using Fit = DensityFitFilter<CTImage>;
using Options = std::map<std::string, std::string>;

double
Number(const Options & options, const std::string & name, double otherwise)
{
  const auto found = options.find(name);
  return found == options.end() ? otherwise : std::stod(found->second);
}

/** The images of one bone. */
struct Bone
{
  CTImage::Pointer    ct;
  CTImage::Pointer    truth; // what the model is compared with
  LabelImage::Pointer labels;
  int                 label;
  VoxelGrid           grid;
  std::vector<int>    region; // of each voxel; -1 outside the mesh

  bool
  Has(std::size_t voxel) const
  {
    const short value = labels->GetBufferPointer()[voxel];
    return label == 0 ? value != 0 : value == label;
  }
};

bool
HeldOut(const VoxelGrid & grid, std::size_t voxel)
{
  const auto i = static_cast<int>(voxel % grid.size[0]), j = static_cast<int>(voxel / grid.size[0] % grid.size[1]);
  return IsHeldOut(i, j, static_cast<int>(voxel / grid.size[0] / grid.size[1]));
}

Json
Compare(const MeshArrays & mesh, const Bone & bone, const std::function<bool(std::size_t)> & counts)
{
  const float * values = bone.truth->GetBufferPointer();
  const auto    result = CompareDensity(mesh, bone.grid, [&](std::size_t voxel, double & value) {
    value = values[voxel];
    return bone.Has(voxel) && counts(voxel);
  });
  return { { "voxels", result.voxels },     { "uncovered", result.uncovered },
           { "mean", result.meanAbsolute }, { "percent", result.meanAbsolutePercent },
           { "range", result.range },       { "deviation", result.standardDeviation },
           { "bias", result.bias } };
}

/** Mean absolute difference to the linearly interpolated image on an oblique plane through the middle of the bone, mm
 * grid of 0.5, in HU. */
double
CutPlaneError(const MeshArrays & mesh, const Bone & bone)
{
  Vector3 middle = Vector3::Zero();
  for (const Vector3 & p : mesh.points)
  {
    middle += p / static_cast<double>(mesh.points.size());
  }
  const Vector3              normal = Vector3(1, 2, 2) / 3, u = Vector3(2, 1, -2) / 3, v = Vector3(2, -2, 1) / 3;
  const LinearSampler<float> image(bone.truth->GetBufferPointer(), bone.grid.size);
  const Eigen::Matrix3d      toIndex = bone.grid.axes.inverse();
  const TetraLocator         locator(mesh);
  double                     sum = 0;
  std::size_t                count = 0;
  CellLocation               place;
  for (double a = -150; a <= 150; a += 0.5)
  {
    for (double b = -150; b <= 150; b += 0.5)
    {
      const Vector3 x = middle + 0.1 * normal + a * u + b * v;
      place = locator.Find(x, place.cell);
      if (place.Found())
      {
        sum += std::abs(DensityAt(mesh, place) - image(toIndex * (x - bone.grid.origin)));
        ++count;
      }
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

/** Largest jumps of the value and the gradient across faces within regions, at six places of each. */
Json
Jumps(const MeshArrays & mesh)
{
  const int         n = mesh.maximumDegree;
  const std::size_t count = BernsteinCount(n);
  const auto        neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  double            value = 0, gradient = 0, relative = 0;
  const auto        gradientAt = [&](std::size_t t, const Barycentric & mu) {
    const Id4 &  v = mesh.tetrahedra[t];
    const auto & p = mesh.points;
    return BernsteinGradient(n, &mesh.coefficients[t * count], mu, p[v[0]], p[v[1]], p[v[2]], p[v[3]]);
  };
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    for (int face = 0; face < 4; ++face)
    {
      const IdType other = neighbors[t][face];
      if (other <= static_cast<IdType>(t) || mesh.region[other] != mesh.region[t])
      {
        continue;
      }
      for (const auto & e : BernsteinExponents(2))
      {
        if (e[face] > 0)
        {
          continue;
        }
        const Barycentric here = Barycentric(e[0], e[1], e[2], e[3]) / 2;
        Barycentric       there = Barycentric::Zero();
        for (int i = 0; i < 4; ++i)
        {
          const Id4 & w = mesh.tetrahedra[other];
          if (i != face)
          {
            there[std::find(w.begin(), w.end(), mesh.tetrahedra[t][i]) - w.begin()] = here[i];
          }
        }
        const double jump = BernsteinValue(n, &mesh.coefficients[t * count], here) -
                            BernsteinValue(n, &mesh.coefficients[other * count], there);
        const Vector3 slope = gradientAt(t, here);
        const double  turn = (slope - gradientAt(other, there)).norm();
        value = std::max(value, std::abs(jump));
        gradient = std::max(gradient, turn);
        relative = std::max(relative, turn / (1 + slope.norm()));
      }
    }
  }
  return { { "value", value }, { "gradient", gradient }, { "relative", relative } };
}

/** Mean length of the difference between the density's gradient and central differences of the image, HU/mm, at every
 * seventh voxel whose neighbours lie in its region. */
double
GradientError(const MeshArrays & mesh, const Bone & bone)
{
  const TetraLocator                  locator(mesh);
  const auto &                        size = bone.grid.size;
  const std::array<std::ptrdiff_t, 3> stride = { 1, size[0], static_cast<std::ptrdiff_t>(size[0]) * size[1] };
  const float *                       values = bone.truth->GetBufferPointer();
  double                              sum = 0;
  std::size_t                         count = 0, seen = 0;
  CellLocation                        place;
  for (std::ptrdiff_t v = stride[2]; v + stride[2] < static_cast<std::ptrdiff_t>(bone.region.size()); ++v)
  {
    const auto alike = [&](std::ptrdiff_t step) {
      return bone.region[v - step] == bone.region[v] && bone.region[v + step] == bone.region[v];
    };
    if (bone.region[v] < 0 || !std::all_of(stride.begin(), stride.end(), alike) || seen++ % 7 != 0)
    {
      continue;
    }
    const Vector3 index(v % stride[1], v / stride[1] % size[1], v / stride[2]);
    place = locator.Find(bone.grid.origin + bone.grid.axes * index, place.cell);
    if (place.Found())
    {
      Vector3 differences;
      for (int axis = 0; axis < 3; ++axis)
      {
        differences[axis] = (values[v + stride[axis]] - values[v - stride[axis]]) / 2;
      }
      sum += (DensityGradientAt(mesh, place) - bone.grid.axes.inverse().transpose() * differences).norm();
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

std::vector<int>
RegionsOfVoxels(MeshArrays mesh, const VoxelGrid & grid)
{
  mesh.maximumDegree = 0;
  mesh.degree.assign(mesh.tetrahedra.size(), 0);
  mesh.coefficients.assign(mesh.tetrahedra.size(), 0.0);
  const DensityRaster raster(mesh, grid);
  const std::size_t   size = static_cast<std::size_t>(grid.size[0]) * grid.size[1];
  std::vector<int>    regions(grid.NumberOfVoxels(), -1);
  std::vector<double> values(size);
  std::vector<IdType> cells(size);
  for (int k = 0; k < grid.size[2]; ++k)
  {
    raster.FillSlice(k, 0.0, values.data(), cells.data());
    for (std::size_t v = 0; v < size; ++v)
    {
      regions[k * size + v] = cells[v] < 0 ? -1 : mesh.region.empty() ? 0 : mesh.region[cells[v]];
    }
  }
  return regions;
}

Fit::Pointer
MakeFit(DensityMesh<double> * mesh, const Bone & bone, const Options & options, int degree)
{
  auto fit = Fit::New();
  fit->SetMesh(mesh);
  fit->SetImage(bone.ct);
  fit->SetDegree(degree);
  fit->SetContinuous(Number(options, "continuous", 0) > 0);
  fit->SetContinuousGradient(Number(options, "gradient", 0) > 0);
  fit->SetVoxelWeight(Number(options, "voxelweight", fit->GetVoxelWeight()));
  fit->SetTikhonov(Number(options, "tikhonov", fit->GetTikhonov()));
  fit->SetOvershootLimit(Number(options, "limit", fit->GetOvershootLimit()));
  fit->SetSurfaceMargin(Number(options, "margin", fit->GetSurfaceMargin()));
  fit->SetMaximumError(Number(options, "maxerror", 0));
  const auto interpolator = options.find("interpolator");
  if (interpolator != options.end() && interpolator->second == "bspline")
  {
    fit->SetInterpolator(DensityInterpolator::CubicBSpline);
  }
  return fit;
}

Json
Measure(DensityMesh<double> * mesh, const Bone & bone, const Options & options, int degree)
{
  auto   fit = MakeFit(mesh, bone, options, degree);
  double seconds = std::numeric_limits<double>::infinity();
  for (int run = 0; run < static_cast<int>(Number(options, "repeat", 1)); ++run)
  {
    fit->Modified();
    const auto start = std::chrono::steady_clock::now();
    fit->Update();
    seconds = std::min(seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  const MeshArrays         fitted = fit->GetOutput()->GetArrays();
  const DensityFitReport & report = fit->GetReport();
  Json                     entry;
  entry["degree"] = degree;
  entry["tetrahedra"] = fitted.tetrahedra.size();
  entry["points"] = fitted.points.size();
  entry["coefficients"] = fit->GetNumberOfFreeCoefficients();
  entry["seconds"] = seconds;
  entry["all"] = Compare(fitted, bone, [](std::size_t) { return true; });
  for (const int region : { 1, 2, 3 })
  {
    entry["region" + std::to_string(region)] =
      Compare(fitted, bone, [&](std::size_t voxel) { return bone.region[voxel] == region; });
  }
  entry["cut"] = CutPlaneError(fitted, bone);
  entry["overshoot"] = { { "median", report.overshootMedian },
                         { "p90", report.overshoot90 },
                         { "largest", report.overshootMaximum },
                         { "limited", report.limited } };
  entry["sparse"] = report.sparse;
  double mass = 0;
  for (const RegionDensity & region : MeasureRegions(fitted))
  {
    mass += region.mass;
  }
  entry["mass"] = mass;
  std::map<int, std::size_t> degrees;
  for (const int d : fitted.degree)
  {
    ++degrees[d];
  }
  for (const auto & [d, count] : degrees)
  {
    entry["degrees"][std::to_string(d)] = count;
  }
  if (Number(options, "joins", 0) > 0)
  {
    entry["jumps"] = Jumps(fitted);
    entry["gradientError"] = GradientError(fitted, bone);
  }
  if (bone.truth == bone.ct)
  {
    fit->HoldOutOn();
    fit->Update();
    const MeshArrays blind = fit->GetOutput()->GetArrays();
    entry["heldOut"] = Compare(blind, bone, [&](std::size_t voxel) { return HeldOut(bone.grid, voxel); });
  }
  return entry;
}

void
Run(int argc, char * argv[])
{
  Options options;
  for (int a = 5; a < argc; ++a)
  {
    const std::string text = argv[a];
    options[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
  }
  Bone bone;
  bone.ct = ReadCT(argv[2]);
  bone.truth = options.count("truth") > 0 ? ReadCT(options["truth"]) : bone.ct;
  bone.labels = ReadLabels(argv[3]);
  bone.label = std::stoi(argv[4]);
  bone.grid = MakeVoxelGrid(*bone.ct, bone.ct->GetBufferedRegion());
  const auto mesh = ReadDensityMesh(argv[1]);
  bone.region = RegionsOfVoxels(mesh->GetArrays(), bone.grid);
  double      sum = 0, inMesh = 0;
  std::size_t count = 0, countInMesh = 0;
  for (std::size_t voxel = 0; voxel < bone.region.size(); ++voxel)
  {
    if (bone.region[voxel] >= 0)
    {
      inMesh += bone.ct->GetBufferPointer()[voxel];
      ++countInMesh;
    }
    if (bone.Has(voxel))
    {
      sum += bone.ct->GetBufferPointer()[voxel];
      ++count;
    }
  }
  Json               entries = Json::array();
  std::istringstream degrees(options.count("degrees") > 0 ? options["degrees"] : "0,1,2,3,4,5,6,7,8");
  for (std::string degree; std::getline(degrees, degree, ',');)
  {
    Json entry = Measure(mesh, bone, options, std::stoi(degree));
    entry["labelMass"] = sum * bone.grid.VoxelVolume();
    entry["labelVoxels"] = count;
    entry["meshVoxelMass"] = inMesh * bone.grid.VoxelVolume();
    entry["meshVoxels"] = countInMesh;
    entries.push_back(entry);
  }
  std::cout << entries.dump(1) << '\n';
}
} // namespace

int
main(int argc, char * argv[])
{
  if (argc < 5)
  {
    std::cerr << "usage: boneDensityValidation MESH.vtu CT LABELS LABEL [name=value ...]\n";
    return 2;
  }
  try
  {
    Run(argc, argv);
    return 0;
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
