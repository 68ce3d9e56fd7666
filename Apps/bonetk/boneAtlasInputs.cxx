/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasInputs.h"

#include "boneIOError.h"
#include "boneModelIO.h"

#include <cstdio>

namespace bone
{
StatisticalModel::Pointer
ReadAtlasWithDensity(const std::string & path)
{
  auto atlas = ReadStatisticalModel(path);
  if (!atlas->GetContent().mean.HasDensity())
  {
    throw IOError(path, "has no density, which images show: train it with meshes that have one (bonetk fit, build)");
  }
  return atlas;
}

std::string
DescribeFound(const VolumeRegistrationResult & result)
{
  char line[200];
  std::snprintf(line,
                sizeof(line),
                "%s%s, %.0f %% of the surface in the CT, of that %.0f %% on edges; volume %.1f +- %.1f cm^3",
                ParameterText(result.quality).c_str(),
                result.mirrored ? ", mirrored" : "",
                100.0 * result.support.visible,
                100.0 * result.support.supported,
                1e-3 * result.regions.back().volume,
                1e-3 * result.regions.back().volumeDeviation);
  return line;
}

CTRegistration::Pointer
FindInCT(const std::string & atlas, const CTImage * ct, const AtlasVolumeParameters & parameters, Session & session)
{
  auto registration = CTRegistration::New();
  registration->SetImage(ct);
  registration->SetModel(ReadAtlasWithDensity(atlas));
  registration->SetParameters(parameters);
  session.Watch(registration, "register");
  registration->Update();
  const VolumeRegistrationResult & result = registration->GetResult();
  session.Print(atlas + ": " + DescribeFound(result) + "\n");
  if (result.quality != RegistrationQuality::Ok)
  {
    session.WarnAlways(atlas + ": of the surface found, " +
                       std::to_string(std::lround(100.0 * result.support.supported)) +
                       " % lie on edges of the CT: look at it");
  }
  return registration;
}
} // namespace bone
