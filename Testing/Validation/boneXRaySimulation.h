/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneXRaySimulation_h
#define boneXRaySimulation_h

#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen

#include "boneAttenuationImageFilter.h"
#include "boneImageIO.h"
#include "boneMeshArrays.h"
#include "boneRadiographView.h"
#include "boneVoxelDRRImageFilter.h"

#include <itkRecursiveGaussianImageFilter.h>

#include <random>

namespace bone
{
/** How an X-ray comes about. */
struct XRaySimulation
{
  double photons{ 50000 }; ///< of the open beam, a pixel
  double scatterToPrimary{ 0.6 };
  double scatterWidth{ 30.0 }; ///< mm at the detector
  double blur{ 0.5 };          ///< pixels
};

inline CTImage::Pointer
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
inline RadiographView
Simulate(const CTImage *            ct,
         const XRayGeometry::View & view,
         const XRaySimulation &     simulation,
         std::mt19937_64 &          random)
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

/** A square view of the points' box along a direction turned by `angle` degrees about `up` from `front`, with `room` on
 * each side, of the box's sides: 700 mm from the source to the box, 1000 mm to the detector. */
inline XRayGeometry::View
MakeView(const std::vector<Vector3> & points,
         const Vector3 &              front,
         const Vector3 &              up,
         double                       angle,
         int                          pixels,
         double                       room = 0.1)
{
  Vector3 lower = Vector3::Constant(1e30), upper = Vector3::Constant(-1e30);
  for (const Vector3 & x : points)
  {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const Vector3 border = room * (upper - lower);
  const double  turn = angle * std::acos(-1.0) / 180.0;
  const Vector3 beam = std::cos(turn) * front + std::sin(turn) * front.cross(up);
  auto          view = XRayGeometry::Framing(lower - border, upper + border, beam, up, 700, 1000, pixels);
  // A square detector about the same centre.
  const Vector3 centre = view.detectorOrigin + 0.5 * (view.size[0] - 1) * view.spacing[0] * view.detectorU +
                         0.5 * (view.size[1] - 1) * view.spacing[1] * view.detectorV;
  view.size = { { pixels, pixels } };
  view.detectorOrigin =
    centre - 0.5 * (pixels - 1) * (view.spacing[0] * view.detectorU + view.spacing[1] * view.detectorV);
  return view;
}
} // namespace bone

#endif
