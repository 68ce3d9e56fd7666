/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildInformation.h"

#include <Eigen/Core>
#include <itkVersion.h>
#include <vtkVersion.h>

namespace bone
{
std::string
DescribeVersion()
{
  const BuildInformation & build = GetBuildInformation();
  return build.version + (build.commit.empty() ? "" : ", commit " + build.commit + (build.changed ? ", changed" : ""));
}

std::string
DescribeBuild()
{
  const BuildInformation & build = GetBuildInformation();
  const std::string eigen = std::to_string(EIGEN_WORLD_VERSION) + '.' + std::to_string(EIGEN_MAJOR_VERSION) + '.' +
                            std::to_string(EIGEN_MINOR_VERSION);
  std::string text = "bonetk " + build.version + '\n';
  text += "commit     " + (build.commit.empty() ? "unknown: built without git" : build.commit + " of " + build.date) +
          (build.changed ? ", changed\n" : "\n");
  text += "compiler   " + build.compiler + ", " + build.configuration + '\n';
  return text + "libraries  ITK " + itk::Version::GetITKVersion() + ", VTK " + vtkVersion::GetVTKVersion() +
         ", Eigen " + eigen;
}
} // namespace bone
