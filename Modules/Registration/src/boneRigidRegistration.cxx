/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRigidRegistration.h"

#include "boneFlatCut.h"
#include "boneRigidBundle.h"
#include "boneRigidSearch.h"

#include <stdexcept>

#include <algorithm>

namespace bone
{
namespace
{
/** Whether the pose lies beyond the translations that were to be searched, by more than two of its deviations. */
bool
IsBeyondSearch(const RigidRegistrationResult &   result,
               const RigidPose &                 initial,
               const RigidRadiographParameters & parameters)
{
  const Vector3 step = result.pose.translation - initial.About(result.pose.centre).translation;
  const Vector3 deviation = result.covariance.diagonal().head<3>().cwiseSqrt();
  return parameters.searchTranslation > 0.0 &&
         (step.cwiseAbs() - 2.0 * deviation).maxCoeff() > BeyondTranslations * parameters.searchTranslation;
}
} // namespace

RigidBundleResult
RegisterRigidBodies(const std::vector<std::vector<MeshArrays>> &           bodies,
                    const std::vector<RadiographView> &                    views,
                    const RigidPose &                                      initial,
                    const RigidRadiographParameters &                      parameters,
                    const Execution &                                      execution,
                    const std::function<void(const RigidPose &, double)> & observe)
{
  if (views.size() == 1 && (parameters.viewTranslationDeviation > 0.0 || parameters.viewRotationDeviation > 0.0))
  {
    throw std::invalid_argument("One view has no other that could be elsewhere: leave ViewTranslationDeviation and "
                                "ViewRotationDeviation 0, or give a second view.");
  }
  constexpr double         searched = 0.8; // of the time
  const auto               share = searched / static_cast<double>(bodies.size());
  RigidBundleResult        result;
  std::vector<MeshArrays>  models;
  std::vector<std::size_t> found;
  result.views.resize(views.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
  {
    const Execution part = execution.Part(share * static_cast<double>(b), share * (static_cast<double>(b) + 1.0));
    auto            levels = FadeFlatCuts(bodies[b], parameters.cutLength);
    result.bodies.push_back(SearchRigid(levels, views, initial, parameters, part, observe));
    models.push_back(std::move(levels.front()));
    if (result.bodies.back().quality != RegistrationQuality::Failed)
    {
      found.push_back(b);
    }
  }
  if (!found.empty())
  {
    AdjustRigidBundle(models, found, views, parameters, execution.Part(searched, 1.0), observe, result);
  }
  // Those that are likely wrong would only mislead the others.
  RigidRadiographParameters exact = parameters;
  exact.viewTranslationDeviation = exact.viewRotationDeviation = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
  {
    if (result.bodies[b].quality == RegistrationQuality::Failed)
    {
      RigidBundleResult alone = result;
      AdjustRigidBundle(models, { b }, views, exact, execution.Silent(), observe, alone);
      result.bodies[b] = alone.bodies[b];
    }
  }
  for (RigidRegistrationResult & body : result.bodies)
  {
    // The search leaves out the depth of one view.
    if (views.size() == 1 && IsBeyondSearch(body, initial, parameters))
    {
      body.beyondSearch = true;
      body.quality = std::max(body.quality, RegistrationQuality::Suspect);
    }
  }
  execution.Report(1.0);
  return result;
}

RigidRegistrationResult
RegisterRigid(const std::vector<MeshArrays> &                        levels,
              const std::vector<RadiographView> &                    views,
              const RigidPose &                                      initial,
              const RigidRadiographParameters &                      parameters,
              const Execution &                                      execution,
              const std::function<void(const RigidPose &, double)> & observe)
{
  return RegisterRigidBodies({ levels }, views, initial, parameters, execution, observe).bodies.front();
}
} // namespace bone
