/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegistrationViews_h
#define boneRegistrationViews_h

#include "boneResultPage.h"
#include "boneSession.h"

#include "boneRadiographRegistrationBase.h"

#include "boneCanvas.h"
#include "boneImageIO.h"
#include "bonePoseInitializer.h"
#include "boneRadiographPreprocessParameters.h"
#include "boneXRayConventions.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace bone
{
/** \defgroup RegistrationViews What the commands that register to X-rays share: X-rays, their views and the start
 * \{ */

struct RegistrationViewOptions
{
  std::vector<std::string>       xrays;
  std::string                    geometry;
  std::vector<double>            carm;
  CArmView                       distances;
  std::vector<std::string>       masks;
  std::string                    initial;
  std::string                    landmarks;
  std::vector<std::string>       imageLandmarks;
  PageOption                     page;
  std::vector<double>            search; ///< empty, or mm along each axis and degrees about each
  CLI::Option *                  valuesOption{ nullptr };
  CLI::Option *                  cropOption{ nullptr };
  RadiographPreprocessParameters preprocess;
  PoseInitializerParameters      initializer;
};

/** An X-ray made ready. */
struct PreparedView
{
  XRayGeometry::Pointer geometry;
  CTImage::Pointer      integrals;
  CTImage::Pointer      weights;
  bool                  monotoneOnly{ false }; ///< some rising function of line integrals
};

/** Adds the options of the views, their preprocessing, landmarks, initial transform and search, whose default reads
 * `search`. `options` must live as long as the command. */
void
AddRegistrationViewOptions(CLI::App * command, RegistrationViewOptions & options, const std::string & search);

/** Throws UsageError where numbers of files and angles do not suit. */
void
VerifyViewOptions(const RegistrationViewOptions & options);

/** The X-rays as line integrals, with their geometries; warns of what their files leave open. Throws IOError and
 * UsageError. */
std::vector<PreparedView>
ReadRegistrationViews(const RegistrationViewOptions & options, Session & session);

/** Where the search begins: the transform given, what landmarks say, or nothing: the model as it lies. */
itk::Euler3DTransform<double>::Pointer
ReadInitialTransform(const RegistrationViewOptions &   options,
                     const std::vector<PreparedView> & views,
                     Session &                         session);

/** OUT_V1.png, ...: names of the pictures. */
std::string
PictureNameOf(const std::string & output, std::size_t view);

/** Writes a picture of each view with the model in its pose, DrawRegistration, and returns them. */
std::vector<Canvas>
WriteRegistrationPictures(const std::vector<PreparedView> & views,
                          const MeshArrays &                model,
                          const RigidPose &                 pose,
                          const std::string &               output,
                          const Eigen::Matrix3d &           patientAxes = Eigen::Matrix3d::Identity());

/** Sets the members SearchTranslation and SearchRotation of a registration's parameters. */
template <typename TParameters>
void
ApplySearch(const RegistrationViewOptions & options, TParameters & parameters)
{
  if (!options.search.empty())
  {
    parameters.searchTranslation = options.search[0];
    parameters.searchRotation = options.search[1];
  }
}

/** Gives a registration its views and initial transform. */
template <typename TRegistration>
void
ConnectViews(const RegistrationViewOptions &   options,
             const std::vector<PreparedView> & views,
             TRegistration &                   registration,
             Session &                         session)
{
  for (unsigned int v = 0; v < views.size(); ++v)
  {
    registration.SetView(v, views[v].integrals, views[v].geometry, views[v].weights);
  }
  if (const auto initial = ReadInitialTransform(options, views, session))
  {
    registration.SetInitialTransform(initial);
  }
}
/** \} */
} // namespace bone

#endif
