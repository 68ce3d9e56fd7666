/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// Measures contours followed from one start contour, for contours.py:
//   boneContourValidation phantom NAME SUBJECT NOISE START [STEP [PIXEL [OUT]]]   START: share of the bone's height
//   boneContourValidation bone CT LABELS LABEL labels|contour [STEP [OUT]]
// Both print `key value` lines; `slice` lines hold what was found slice by slice.

#include "boneContourIO.h"
#include "boneImageIO.h"
#include "boneLabelContours.h"
#include "boneMakePhantom.h"
#include "bonePhantomImageSource.h"
#include "boneSnake.h"
#include "boneSnakeContourFilter.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <limits>
#include <map>
#include <random>
#include <string>

namespace
{
using namespace bone;
using Filter = SnakeContourFilter<CTImage>;

struct Mean
{
  double sum{ 0.0 };
  double count{ 0.0 };
  void
  Add(double value)
  {
    sum += value;
    count += 1.0;
  }
  double
  Get() const
  {
    return count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  }
};

double
DistanceTo(const Vector2 & q, const std::vector<Polygon> & polygons)
{
  double best = std::numeric_limits<double>::infinity();
  for (const Polygon & polygon : polygons)
  {
    for (std::size_t i = 0; i < polygon.size(); ++i)
    {
      const Vector2 & a = polygon[i];
      const Vector2   d = polygon[(i + 1) % polygon.size()] - a;
      const double    t = std::clamp((q - a).dot(d) / std::max(d.squaredNorm(), 1e-30), 0.0, 1.0);
      best = std::min(best, (q - a - t * d).squaredNorm());
    }
  }
  return std::sqrt(best);
}

std::vector<Polygon>
LoopsOf(const ContourStack & stack, std::size_t k, int layer)
{
  std::vector<Polygon> loops;
  for (const Contour & contour : stack.GetSlices()[k].contours)
  {
    if (contour.layer == layer && !contour.axis)
    {
      Polygon loop;
      for (const Vector3 & p : contour.points)
      {
        loop.push_back(stack.ToPlane(p));
      }
      loops.push_back(std::move(loop));
    }
  }
  return loops;
}

// As by a hand in haste: a point every `spacing` mm, off by up to `error` mm along each axis.
ContourStack::Pointer
DrawnContour(const ContourStack & truth, std::size_t k, double spacing, double error)
{
  const std::vector<Polygon> loops = LoopsOf(truth, k, 0);
  const Polygon &            outline = *std::max_element(
    loops.begin(), loops.end(), [](const Polygon & a, const Polygon & b) { return SignedArea(a) < SignedArea(b); });
  std::mt19937                           random(12345);
  std::uniform_real_distribution<double> jitter(-error, error);
  ContourSlice                           slice;
  slice.origin = truth.GetSlices()[k].origin;
  Contour contour;
  for (const Vector2 & q : ResampleUniform(outline, spacing))
  {
    const double dx = jitter(random);
    const double dy = jitter(random);
    contour.points.push_back(truth.FromPlane(q + Vector2(dx, dy), truth.GetHeight(k)));
  }
  slice.contours.push_back(contour);
  auto stack = ContourStack::New();
  stack->SetFrame(truth.GetU(), truth.GetV());
  stack->SetSlices({ slice });
  return stack;
}

ContourStack::Pointer
OutlineOf(const CTImage * ct, const LabelImage * labels, int label, double step)
{
  auto filter = Filter::New();
  filter->SetInput(ct);
  filter->SetLabelImage(labels);
  filter->SetLabel(label);
  filter->SetSliceStep(step);
  filter->SetNumberOfLayers(1);
  filter->Update();
  return filter->GetOutput();
}

double
Follow(Filter * filter)
{
  const auto begin = std::chrono::steady_clock::now();
  filter->Update();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Both ways along the outlines of one slice: mean distance and share of the reference further than 1 mm from a contour.
struct Agreement
{
  Mean   distance;
  Mean   missed;
  double worst{ 0.0 };
};

Agreement
Compare(const std::vector<Polygon> & found, const std::vector<Polygon> & reference)
{
  Agreement  agreement;
  const auto visit = [&agreement](const std::vector<Polygon> & from, const std::vector<Polygon> & to, bool back) {
    for (const Polygon & loop : from)
    {
      for (const Vector2 & q : ResampleUniform(loop, 0.6))
      {
        const double d = DistanceTo(q, to);
        if (back)
        {
          agreement.missed.Add(d > 1.0 ? 1.0 : 0.0);
        }
        if (std::isfinite(d))
        {
          agreement.distance.Add(d);
          agreement.worst = std::max(agreement.worst, d);
        }
      }
    }
  };
  visit(found, reference, false);
  visit(reference, found, true);
  return agreement;
}

// Reference outlines by height.
std::size_t
SliceAt(const ContourStack & stack, double height, double slack)
{
  for (std::size_t k = 0; k < stack.GetSlices().size(); ++k)
  {
    if (std::abs(stack.GetHeight(k) - height) < slack)
    {
      return k;
    }
  }
  return stack.GetSlices().size();
}

void
PrintReport(const Filter & filter)
{
  for (const std::string & warning : filter.GetWarnings())
  {
    std::cout << "warning " << warning << '\n';
  }
}

void
PrintAgreement(const Filter & filter, const ContourStack & found, const ContourStack & reference)
{
  Mean missed;
  for (std::size_t r = 0; r < reference.GetSlices().size(); ++r)
  {
    const double    height = reference.GetHeight(r);
    const auto      k = SliceAt(found, height, 0.01);
    const bool      there = k < found.GetSlices().size();
    const auto      loops = there ? LoopsOf(found, k, 0) : std::vector<Polygon>{};
    const Agreement agreement = Compare(loops, LoopsOf(reference, r, 0));
    missed.sum += agreement.missed.sum;
    missed.count += agreement.missed.count;
    std::cout << "slice " << height << ' ' << loops.size() << ' ' << LoopsOf(reference, r, 0).size() << ' '
              << agreement.distance.Get() << ' ' << agreement.worst << ' ' << agreement.missed.Get();
    for (const SliceReport & line : filter.GetReport().slices)
    {
      if (std::abs(line.height - height) < 0.01)
      {
        std::cout << ' ' << line.iterations << ' ' << line.converged << ' ' << line.support << " \"" << line.events
                  << '"';
      }
    }
    std::cout << '\n';
  }
  int surplus = 0;
  for (std::size_t k = 0; k < found.GetSlices().size(); ++k)
  {
    surplus += SliceAt(reference, found.GetHeight(k), 0.01) == reference.GetSlices().size();
  }
  std::cout << "missed " << missed.Get() << "\nsurplus_slices " << surplus << '\n';
}

void
PrintTrueErrors(const PhantomModel & model, const ContourStack & found, double resolved)
{
  Mean outer;
  Mean outerSigned;
  Mean inner;
  Mean innerSigned;
  Mean thin;
  Mean thinSigned;
  for (const ContourSlice & slice : found.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      for (std::size_t i = 0; i < contour.points.size() && contour.layer < 2; i += contour.layer == 0 ? 1 : 3)
      {
        const Vector3 & p = contour.points[i];
        if (contour.layer == 0)
        {
          const double d = model.SignedDistance(p);
          outer.Add(std::abs(d));
          outerSigned.Add(d);
          continue;
        }
        const double d = model.Distance(PhantomModel::Endosteal, p);
        if (model.CorticalThickness(p) < resolved)
        {
          thin.Add(std::abs(d));
          thinSigned.Add(d);
          continue;
        }
        inner.Add(std::abs(d));
        innerSigned.Add(d);
      }
    }
  }
  std::cout << "periosteal " << outer.Get() << "\nperiosteal_signed " << outerSigned.Get() << "\nendosteal "
            << inner.Get() << "\nendosteal_signed " << innerSigned.Get() << "\nendosteal_points " << inner.count
            << "\nendosteal_thin " << thin.Get() << "\nendosteal_thin_signed " << thinSigned.Get()
            << "\nendosteal_thin_points " << thin.count << '\n';
}

int
RunPhantom(int argc, char ** argv)
{
  const auto model = MakePhantom(argv[2], std::strtoull(argv[3], nullptr, 10));
  auto       source = PhantomImageSource<CTImage>::New();
  source->SetModel(model);
  CTImage::SpacingType spacing;
  const double         pixel = argc > 7 ? std::atof(argv[7]) : 0.6;
  spacing[0] = spacing[1] = pixel;
  spacing[2] = 1.0;
  source->SetSpacing(spacing);
  source->SetNoise(std::atof(argv[4]));
  source->SetNoiseSeed(std::strtoull(argv[3], nullptr, 10) + 1);
  source->Update();
  const double step = argc > 6 ? std::atof(argv[6]) : 0.0;
  const auto   all = OutlineOf(source->GetOutput(), source->GetLabelOutput(), 0, 0.0);
  const auto   share = std::atof(argv[5]) * static_cast<double>(all->GetSlices().size() - 1);
  auto         filter = Filter::New();
  filter->SetInput(source->GetOutput());
  filter->SetInitialContours(DrawnContour(*all, static_cast<std::size_t>(std::lround(share)), 4.0, 0.8));
  filter->SetSliceStep(step);
  const double seconds = Follow(filter);
  std::cout << "seconds " << seconds << "\nslices " << filter->GetOutput()->GetSlices().size() << '\n';
  PrintTrueErrors(*model, *filter->GetOutput(), 2.0 * pixel);
  PrintAgreement(*filter, *filter->GetOutput(), *all);
  PrintReport(*filter);
  if (argc > 8)
  {
    WriteContours(filter->GetOutput(), argv[8]);
    WriteImage(source->GetOutput(), std::string(argv[8]) + ".mha");
  }
  return EXIT_SUCCESS;
}

int
RunBone(int argc, char ** argv)
{
  const auto   ct = ReadCT(argv[2]);
  const auto   labels = ReadLabels(argv[3]);
  const int    label = std::atoi(argv[4]);
  const double step = argc > 6 ? std::atof(argv[6]) : 0.0;
  const auto   outline = OutlineOf(ct, labels, label, 0.0);
  auto         filter = Filter::New();
  filter->SetInput(ct);
  filter->SetSliceStep(step);
  if (std::strcmp(argv[5], "labels") == 0)
  {
    filter->SetLabelImage(labels);
    filter->SetLabel(label);
    filter->RefineLabelOutlineOn();
  }
  else
  {
    filter->SetInitialContours(DrawnContour(*outline, 0, 4.0, 0.8));
  }
  const double seconds = Follow(filter);
  std::cout << "seconds " << seconds << "\nslices " << filter->GetOutput()->GetSlices().size() << '\n';
  PrintAgreement(*filter, *filter->GetOutput(), *outline);
  PrintReport(*filter);
  if (argc > 7)
  {
    WriteContours(filter->GetOutput(), argv[7]);
  }
  return EXIT_SUCCESS;
}
} // namespace

int
main(int argc, char ** argv)
{
  try
  {
    if (argc >= 6 && std::strcmp(argv[1], "phantom") == 0)
    {
      return RunPhantom(argc, argv);
    }
    if (argc >= 6 && std::strcmp(argv[1], "bone") == 0)
    {
      return RunBone(argc, argv);
    }
    std::cerr << "usage: boneContourValidation phantom NAME SUBJECT NOISE START [STEP [PIXEL [OUT]]]\n"
                 "       boneContourValidation bone CT LABELS LABEL labels|contour [STEP [OUT]]\n";
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
  }
  return EXIT_FAILURE;
}
