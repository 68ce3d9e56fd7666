/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// Figures of the registration of a standard model to surfaces whose correspondence is known:
// boneAtlasValidation STANDARD.vtu REFERENCE.ply SUBJECT.ply... ; see atlas.py.

#include "boneAtlasRegistration.h"
#include "boneMeshIO.h"
#include "boneModelEvaluation.h"

#include <ctime>
#include <iostream>
#include <numeric>
#include <random>

namespace
{
using namespace bone;

struct Place
{
  int     triangle;
  Vector3 weights;
};

/** Throws the surface into a pose and shuffles its vertices and triangles. */
AffineMap
Disguise(TriangleSurface & surface, unsigned seed)
{
  std::mt19937                     generator(seed);
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(generator), normal(generator), normal(generator), normal(generator));
  AffineMap          pose;
  pose.linear = q.normalized().toRotationMatrix();
  pose.translation = 200 * Vector3(normal(generator), normal(generator), normal(generator));
  std::vector<IdType> order(surface.points.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), generator);
  std::vector<Vector3> points(surface.points.size());
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    points[order[p]] = pose(surface.points[p]);
  }
  surface.points = points;
  for (auto & t : surface.triangles)
  {
    t = { order[t[0]], order[t[1]], order[t[2]] };
  }
  std::shuffle(surface.triangles.begin(), surface.triangles.end(), generator);
  return pose;
}

/** Processor seconds of all threads. */
double
Cpu()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double
Percentile(std::vector<double> values, double share)
{
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

double
Mean(const std::vector<double> & values)
{
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}
} // namespace

int
main(int argc, char ** argv)
{
  const MeshArrays      standard = ReadMeshArrays(argv[1]);
  const TriangleSurface reference = ReadTriangleSurface(argv[2]);
  const StandardModel     model(standard);
  const TriangleSurface & source = model.GetSurface();
  const DirectedSurface known(reference);
  std::vector<Place>    places;
  std::vector<double>   offset;
  for (const Vector3 & x : source.points)
  {
    const auto match = known.FindAny(x);
    places.push_back({ match.triangle, known.Weights(match.triangle, match.point) });
    offset.push_back(std::sqrt(match.squaredDistance));
  }
  std::cout << source.points.size() << " exterior points, " << Mean(offset) << " mm from the reference\n";
  RegistrationParameters parameters;
  parameters.interior = getenv("FRAMES") ? InteriorRule::EigenFrame : InteriorRule::Harmonic;
  parameters.method = getenv("NICP") ? DeformationMethod::NonRigidICP : DeformationMethod::AdaptiveFocus;
  AdaptiveFocusParameters & focus = parameters.focus;
  if (const char * f = getenv("RINGS"))
  {
    focus.rings.clear();
    std::istringstream in(f);
    int                r;
    while (in >> r)
      focus.rings.push_back(r);
  }
  if (getenv("RIDGE")) focus.ridge = atof(getenv("RIDGE"));
  if (getenv("SLIDE")) focus.slide = atof(getenv("SLIDE"));
  if (getenv("ITER")) focus.iterations = atoi(getenv("ITER"));
  if (getenv("WIDTH")) focus.attributeWidth = atof(getenv("WIDTH"));
  if (getenv("FOCUS")) focus.focus = atof(getenv("FOCUS"));
  std::vector<std::vector<Vector3>> found, truth;
  std::vector<double>               all;
  for (int s = 3; s < argc; ++s)
  {
    const TriangleSurface original = ReadTriangleSurface(argv[s]);
    TriangleSurface       subject = original;
    const AffineMap       pose = Disguise(subject, static_cast<unsigned>(s));
    const double          start = Cpu();
    RegistrationReport    report;
    std::vector<Vector3>  points;
    try
    {
      points = model.Register(subject, parameters, report);
    }
    catch (const std::runtime_error & e)
    {
      std::cout << argv[s] << ": " << e.what() << std::endl;
      continue;
    }
    const double          end = Cpu();
    TriangleSurface       moved = source;
    for (std::size_t p = 0; p < moved.points.size(); ++p)
    {
      moved.points[p] = points[model.GetSurfacePointIds()[p]];
    }
    std::vector<double> affineError;
    std::vector<Vector3> expected;
    for (std::size_t p = 0; p < places.size(); ++p)
    {
      const auto & t = reference.triangles[places[p].triangle];
      const Vector3 & w = places[p].weights;
      expected.push_back(pose(w[0] * original.points[t[0]] + w[1] * original.points[t[1]] + w[2] * original.points[t[2]]));
      affineError.push_back((report.alignment(source.points[p]) - expected[p]).norm());
    }
    std::vector<double> error;
    for (std::size_t p = 0; p < places.size(); ++p)
    {
      error.push_back((moved.points[p] - expected[p]).norm());
    }
    all.insert(all.end(), error.begin(), error.end());
    std::cout << argv[s] + std::string(argv[s]).rfind('/') + 1 << " affine rms " << report.alignmentDistance << " corr "
              << Mean(affineError) << " | surface " << report.surfaceDistance << " back " << report.subjectDistance << " corr mean "
              << Mean(error) << " median " << Percentile(error, 0.5) << " 95% " << Percentile(error, 0.95) << " max "
              << Percentile(error, 1) << " inverted " << report.untangling.before << " " << report.untangling.after << " moved "
              << report.untangling.moved << " by " << report.untangling.exterior << " s " << end - start << std::endl;
    found.push_back(moved.points);
    truth.push_back(expected);
  }
  std::cout << "all: median " << Percentile(all, 0.5) << " mean " << Mean(all) << '\n';
  if (found.size() > 4)
  {
    EvaluationParameters e;
    e.samples = 0;
    const auto a = EvaluateShapes(found, e), b = EvaluateShapes(truth, e);
    for (std::size_t m = 0; m < a.size(); ++m)
    {
      std::cout << a[m].modes << " modes: " << a[m].generalisation.mean << " against " << b[m].generalisation.mean << '\n';
    }
  }
}
