/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRegistrationViews.h"

#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneGeometryIO.h"
#include "boneLandmarkIO.h"
#include "boneRadiographPreprocessFilter.h"
#include "boneRegistrationReport.h"
#include "boneTransformIO.h"
#include "boneXRayIO.h"

namespace bone
{
namespace
{
/** The geometry of each X-ray: of the file of views, of the C-arm's angles, or of the X-rays themselves. */
std::vector<XRayGeometry::Pointer>
GeometryOf(const RegistrationViewOptions & options, const std::vector<XRayFile> & files)
{
  std::vector<XRayGeometry::Pointer> views;
  if (!options.geometry.empty())
  {
    views = ReadGeometry(options.geometry);
    if (views.size() != files.size())
    {
      throw UsageError(options.geometry + " has " + std::to_string(views.size()) + " views, but there are " +
                       std::to_string(files.size()) + " X-rays");
    }
    return views;
  }
  for (std::size_t v = 0; v < files.size(); ++v)
  {
    XRayGeometry::View view;
    if (!options.carm.empty())
    {
      CArmView   arm = options.distances;
      const auto size = files[v].image->GetLargestPossibleRegion().GetSize();
      arm.primary = options.carm[2 * v];
      arm.secondary = options.carm[2 * v + 1];
      arm.size = { { static_cast<int>(size[0]), static_cast<int>(size[1]) } };
      arm.spacing = { files[v].image->GetSpacing()[0], files[v].image->GetSpacing()[1] };
      view = FromCArm(arm);
    }
    else if (files[v].view)
    {
      view = *files[v].view;
    }
    else
    {
      std::string reasons;
      for (const std::string & obstacle : files[v].obstacles)
      {
        reasons += (reasons.empty() ? " (" : "; ") + obstacle;
      }
      throw UsageError(options.xrays[v] + " does not say how it was taken" + reasons + (reasons.empty() ? "" : ")") +
                       ": give --geometry or --carm");
    }
    views.push_back(XRayGeometry::New());
    views.back()->SetView(view);
  }
  return views;
}
} // namespace

void
AddRegistrationViewOptions(CLI::App * command, RegistrationViewOptions & options, const std::string & search)
{
  command->add_option("--xray", options.xrays, "X-rays: DICOM, or images of columns x rows pixels")->required();
  auto * geometry = command->add_option("--geometry", options.geometry, "Views of the X-rays, in their order (.json)");
  auto * carm = command
                  ->add_option("--carm",
                               options.carm,
                               "C-arm's primary (LAO positive) and secondary angle (CRA positive) of each X-ray, "
                               "degrees; isocentre at the origin")
                  ->excludes(geometry);
  command->add_option("--source-isocentre", options.distances.sourceToIsocenter, "Source to isocentre, mm; default 700")
    ->check(Length())
    ->needs(carm);
  command->add_option("--source-detector", options.distances.sourceToDetector, "Source to detector, mm; default 1000")
    ->check(Length())
    ->needs(carm);
  command->add_option("--mask", options.masks, "Images of the X-rays' sizes: pixels that are 0 do not count");
  AddParameterOptions(command, options.preprocess);
  options.valuesOption = command->get_option("--xray-values");
  options.cropOption = command->get_option("--crop");
  command->add_option(
    "--initial", options.initial, "Transform from the model's space to the views' to begin with (.tfm)");
  auto * landmarks =
    command->add_option("--landmarks", options.landmarks, "Landmarks of the model, to begin with (.mrk.json, .json)");
  command
    ->add_option("--xray-landmarks",
                 options.imageLandmarks,
                 "The same landmarks on each X-ray (.mrk.json, or .json with columns and rows)")
    ->needs(landmarks);
  landmarks->needs("--xray-landmarks");
  AddParameterOptions(command, options.initializer);
  options.page.AddTo(command);
  command
    ->add_option("--search",
                 options.search,
                 "How far the start may be off: mm along each axis, degrees about each; default " + search +
                   "; 0 0: refine only")
    ->expected(2)
    ->check(NotNegative());
}

void
VerifyViewOptions(const RegistrationViewOptions & options)
{
  if (!options.masks.empty() && options.masks.size() != options.xrays.size())
  {
    throw UsageError("give as many --mask as --xray");
  }
  if (!options.carm.empty() && options.carm.size() != 2 * options.xrays.size())
  {
    throw UsageError("--carm needs a primary and a secondary angle for each --xray");
  }
  if (options.imageLandmarks.size() > options.xrays.size())
  {
    throw UsageError("there are more --xray-landmarks than --xray");
  }
}

std::vector<PreparedView>
ReadRegistrationViews(const RegistrationViewOptions & options, Session & session)
{
  std::vector<XRayFile> files;
  for (const std::string & path : options.xrays)
  {
    files.push_back(ReadXRay(path));
    for (const std::string & note : files.back().notes)
    {
      session.Warn(path + ": " + note);
    }
  }
  const auto                geometry = GeometryOf(options, files);
  std::vector<PreparedView> views;
  for (std::size_t v = 0; v < files.size(); ++v)
  {
    auto preprocess = RadiographPreprocessFilter<CTImage, CTImage, LabelImage>::New();
    preprocess->SetInput(files[v].image);
    preprocess->SetParameters(options.preprocess);
    if (options.valuesOption->count() == 0)
    {
      preprocess->SetValues(files[v].values);
      preprocess->SetLargerAttenuates(files[v].largerAttenuates);
    }
    if (options.cropOption->count() == 0)
    {
      preprocess->SetCrop(files[v].crop);
    }
    if (v < options.masks.size())
    {
      const auto mask = ReadRadiograph(options.masks[v]);
      auto       labels = LabelImage::New();
      labels->CopyInformation(mask);
      labels->SetRegions(mask->GetLargestPossibleRegion());
      labels->Allocate();
      std::transform(mask->GetBufferPointer(),
                     mask->GetBufferPointer() + mask->GetLargestPossibleRegion().GetNumberOfPixels(),
                     labels->GetBufferPointer(),
                     [](float x) { return static_cast<short>(x != 0.0f); });
      preprocess->SetMask(labels);
    }
    try
    {
      preprocess->Update();
    }
    catch (const itk::ExceptionObject & error)
    {
      throw IOError(options.xrays[v], ErrorLine(error));
    }
    views.push_back({ geometry[v], preprocess->GetOutput(), preprocess->GetWeights(), preprocess->IsMonotoneOnly() });
  }
  return views;
}

itk::Euler3DTransform<double>::Pointer
ReadInitialTransform(const RegistrationViewOptions &   options,
                     const std::vector<PreparedView> & views,
                     Session &                         session)
{
  itk::Euler3DTransform<double>::Pointer initial;
  if (!options.initial.empty())
  {
    initial = ReadRigidTransform(options.initial);
  }
  if (options.landmarks.empty())
  {
    return initial;
  }
  std::vector<XRayGeometry::View>         geometry;
  std::vector<std::vector<ImageLandmark>> seen;
  for (std::size_t v = 0; v < views.size(); ++v)
  {
    geometry.push_back(views[v].geometry->GetView());
    seen.push_back(v < options.imageLandmarks.size() ? ReadImageLandmarks(options.imageLandmarks[v], geometry[v])
                                                     : std::vector<ImageLandmark>());
  }
  std::optional<PosePrior> prior;
  if (initial.IsNotNull())
  {
    prior = PosePrior{ RigidPose::FromTransform(*initial) };
  }
  const auto pairs = MatchLandmarks(ReadLandmarks(options.landmarks), seen);
  const auto estimate = EstimatePose(geometry, pairs, options.initializer, prior);
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    if (!estimate.inlier[i])
    {
      session.Warn("landmark " + pairs[i].name + " of view " + std::to_string(pairs[i].view + 1) +
                   " does not fit the others and is left out");
    }
  }
  if (estimate.ambiguous)
  {
    session.Warn("the landmarks fit another pose about as well: give more of them, or --initial");
  }
  return estimate.pose.ToTransform();
}

std::string
PictureNameOf(const std::string & output, std::size_t view)
{
  return output + "_V" + std::to_string(view + 1) + ".png";
}

std::vector<Canvas>
WriteRegistrationPictures(const std::vector<PreparedView> & views,
                          const MeshArrays &                model,
                          const RigidPose &                 pose,
                          const std::string &               output,
                          const Eigen::Matrix3d &           patientAxes)
{
  std::vector<Canvas> pictures;
  for (std::size_t v = 0; v < views.size(); ++v)
  {
    const float *  pixels = views[v].integrals->GetBufferPointer();
    const float *  weights = views[v].weights->GetBufferPointer();
    RadiographView xray;
    xray.view = views[v].geometry->GetView();
    xray.values.assign(pixels, pixels + xray.GetNumberOfPixels());
    xray.weights.assign(weights, weights + xray.GetNumberOfPixels());
    pictures.push_back(DrawRegistration(xray, model, pose, patientAxes));
    pictures.back().Write(PictureNameOf(output, v));
  }
  return pictures;
}
} // namespace bone
