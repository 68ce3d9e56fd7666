/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneResolution.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>

namespace bone
{
double
EstimateSurface(const ContourStack & stack)
{
  double length = 0.0;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      for (std::size_t i = 0; i < contour.points.size() && contour.layer == 0 && !contour.axis; ++i)
      {
        length += (contour.points[(i + 1) % contour.points.size()] - contour.points[i]).norm();
      }
    }
  }
  const std::size_t slices = stack.GetSlices().size();
  return slices < 2 ? 0.0 : length / static_cast<double>(slices) * (stack.GetHeight(slices - 1) - stack.GetHeight(0));
}

Resolution
EstimateResolution(double surfaceArea, double sliceSpacing, IdType tetrahedra)
{
  constexpr double ratio = 0.4;
  const double     product = 13.0 * surfaceArea / static_cast<double>(tetrahedra);
  Resolution       resolution;
  resolution.sliceStep = std::max(sliceSpacing, std::sqrt(ratio * product));
  resolution.contourSpacing = product / resolution.sliceStep;
  return resolution;
}

void
SetResolution(BuildPipeline & pipeline, const Resolution & resolution, const ResolutionSearch & search)
{
  // Whole numbers of the image's slices, which stay the same from one trial to the next.
  const double every = std::floor(0.25 * resolution.sliceStep / search.sliceSpacing);
  pipeline.GetSnake()->SetSliceStep(!search.adaptive ? resolution.sliceStep
                                    : every > 1.0    ? every * search.sliceSpacing
                                                     : 0.0);
  pipeline.GetSlices()->SetMeanSpacing(search.adaptive ? resolution.sliceStep : 0.0);
  pipeline.SetContourSpacing(resolution.contourSpacing);
}

IdType
PredictQuality(const MeshArrays & tiled)
{
  // Fitted to ten bones in three numbers of tetrahedra each: 4.9 % of error (root mean square), 5.8 % on bones left
  // out.
  constexpr double wellShaped = 0.5;
  constexpr double atBoundary = 1.78, atInterfaces = 2.41;
  double           tetrahedra = 0.0;
  for (std::size_t t = 0; t < tiled.tetrahedra.size(); ++t)
  {
    for (int face = 0; face < 4; ++face)
    {
      const IdType other = tiled.neighbors[t][face];
      const bool   boundary = other < 0;
      if (!boundary && (other < static_cast<IdType>(t) || tiled.region[t] == tiled.region[other]))
      {
        continue;
      }
      std::array<Vector3, 3> corners;
      for (int k = 0; k < 3; ++k)
      {
        corners[k] = tiled.points[tiled.tetrahedra[t][(face + 1 + k) % 4]];
      }
      const Vector3 a = corners[1] - corners[0], b = corners[2] - corners[0], c = corners[2] - corners[1];
      const double  shape =
        2.0 * std::sqrt(3.0) * a.cross(b).norm() / (a.squaredNorm() + b.squaredNorm() + c.squaredNorm());
      tetrahedra += (boundary ? atBoundary : atInterfaces) * std::sqrt(std::min(1.0, shape / wellShaped));
    }
  }
  return static_cast<IdType>(std::lround(tetrahedra));
}

namespace
{
/** The resolution to try next after one that gave `ratio` times the number asked for. \param power  by which the number
 * goes with what is expected of a change. \param both  whether slices change too where the number is near. */
Resolution
NextResolution(const Resolution & last, double ratio, double power, bool both, const ResolutionSearch & search)
{
  constexpr double far = 0.12;
  Resolution       next = last;
  double           remaining = std::pow(ratio, 1.0 / power);
  if (!search.sliceStepFixed && (both || std::abs(std::log(ratio)) > far))
  {
    next.sliceStep = std::max(search.sliceSpacing, last.sliceStep * std::sqrt(remaining));
    remaining *= last.sliceStep / next.sliceStep;
  }
  // On fixed slices the number of tetrahedra goes with the number of samples, 1 / spacing. Samples much nearer than
  // slices make needles, which the quality stage takes away again.
  constexpr double leastShape = 0.1;
  next.contourSpacing = last.contourSpacing * std::clamp(remaining, 0.4, 2.5);
  if (ratio < 1.0)
  {
    next.contourSpacing = std::max(next.contourSpacing, std::min(last.contourSpacing, leastShape * next.sliceStep));
  }
  return next;
}

/** A resolution of about as many tetrahedra as one that could not be tiled: other slices, or other samples on them. */
Resolution
OtherResolution(const Resolution & last, int trial, const ResolutionSearch & search)
{
  constexpr double change = 0.92;
  Resolution       next = last;
  const double     step = change * last.sliceStep;
  if (trial % 2 == 0 && !search.sliceStepFixed && step >= search.sliceSpacing)
  {
    next.sliceStep = step;
  }
  else
  {
    next.contourSpacing *= change;
  }
  return next;
}
/** Finds a resolution at which the tiling has the number of tetrahedra of the search, as they are predicted. */
Resolution
AdjustTiling(BuildPipeline &                                         pipeline,
             const Resolution &                                      start,
             const ResolutionSearch &                                search,
             const std::function<void(const Resolution &, IdType)> & tried)
{
  constexpr double          tolerance = 0.05, leastChange = 0.05;
  constexpr int             maximumTrials = 6;
  std::exception_ptr        failure;
  std::optional<Resolution> best;
  double                    bestError = 0.0, power = 1.0;
  double                    former = 1.0; // ratio, of which a change to 1 was expected
  bool                      both = false; // slices and spacing are changed together
  Resolution                resolution = start;
  for (int trial = 0; trial < maximumTrials; ++trial)
  {
    SetResolution(pipeline, resolution, search);
    // A failure of the contours is one of the input.
    pipeline.GetSnake()->Update();
    try
    {
      pipeline.GetTiling()->Update();
    }
    catch (const itk::ProcessAborted &)
    {
      throw;
    }
    catch (const itk::ExceptionObject &)
    {
      failure = std::current_exception();
      resolution = OtherResolution(resolution, trial, search);
      former = 1.0;
      continue;
    }
    const IdType count = PredictQuality(pipeline.GetTiling()->GetOutput()->GetArrays());
    if (tried)
    {
      tried(resolution, count);
    }
    const double ratio = static_cast<double>(count) / static_cast<double>(search.tetrahedra);
    if (!best || std::abs(std::log(ratio)) < bestError)
    {
      best = resolution;
      bestError = std::abs(std::log(ratio));
    }
    if (std::abs(ratio - 1.0) <= tolerance)
    {
      break;
    }
    if (std::abs(std::log(former)) > leastChange)
    {
      const double done = 1.0 - std::log(ratio) / std::log(former); // of the change that was expected
      power = std::clamp(power * done, 0.5, 2.0);
      // Thin layers have as many samples as they need, whatever their spacing.
      both = both || done < 0.5;
    }
    former = ratio;
    const Resolution next = NextResolution(resolution, ratio, power, both, search);
    if (next.sliceStep == resolution.sliceStep && next.contourSpacing == resolution.contourSpacing)
    {
      break; // as fine as it goes
    }
    resolution = next;
  }
  if (!best)
  {
    std::rethrow_exception(failure);
  }
  SetResolution(pipeline, *best, search);
  pipeline.GetTiling()->Update();
  return *best;
}
} // namespace

Resolution
AdjustResolution(BuildPipeline &                                         pipeline,
                 const Resolution &                                      start,
                 const ResolutionSearch &                                search,
                 const std::function<void(const Resolution &, IdType)> & tried)
{
  constexpr double tolerance = 0.08;
  constexpr int    maximumTrials = 3;
  ResolutionSearch predicted = search;
  Resolution       resolution = start;
  for (int trial = 0; trial < maximumTrials; ++trial)
  {
    resolution = AdjustTiling(pipeline, resolution, predicted, tried);
    pipeline.GetQuality()->Update();
    const auto count = static_cast<double>(pipeline.GetQuality()->GetOutput()->GetNumberOfTetrahedra());
    if (std::abs(count / static_cast<double>(search.tetrahedra) - 1.0) <= tolerance)
    {
      break;
    }
    const auto foretold = static_cast<double>(PredictQuality(pipeline.GetTiling()->GetOutput()->GetArrays()));
    predicted.tetrahedra = static_cast<IdType>(std::lround(static_cast<double>(search.tetrahedra) * foretold / count));
  }
  return resolution;
}
} // namespace bone
