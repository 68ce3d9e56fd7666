/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildCost.h"

#include <algorithm>

namespace bone
{
namespace
{
// Fitted to builds of phantoms and clinical bones, of 2,000 to 33,000 tetrahedra; the guide says how well.
constexpr double SecondsOfBone = 1.0;          // one thread
constexpr double SecondsOfMillionVoxels = 0.6; // of the bone's box
constexpr double SecondsOfThousandCells = 0.42;
constexpr double SecondsOfReading = 0.03; // a million voxels of the CT
constexpr double ParallelShare = 0.4;     // of a bone's seconds
constexpr double MegabytesOfProgram = 117.0;
constexpr double MegabytesOfMillionVoxels = 14.0;    // while contours are found
constexpr double MegabytesOfMillionVoxelsKept = 6.0; // while the mesh is made
constexpr double MegabytesOfThousandCells = 3.5;
} // namespace

BuildCost
EstimateCost(const BuildSize & size, const BuildParameters & parameters)
{
  constexpr double million = 1e6, thousand = 1e3;
  const double     cells = static_cast<double>(parameters.plan.tetrahedra) / thousand;
  const double     threads = std::max(size.threads, 1u);
  BuildCost        cost{ SecondsOfReading * size.voxels / million, 0.0 };
  for (const double box : size.bones)
  {
    const double voxels = box / million;
    const double seconds = SecondsOfBone + SecondsOfMillionVoxels * voxels + SecondsOfThousandCells * cells;
    cost.seconds += seconds * (1.0 - ParallelShare + ParallelShare / threads);
    const double contours = MegabytesOfMillionVoxels * voxels;
    const double mesh = MegabytesOfMillionVoxelsKept * voxels + MegabytesOfThousandCells * cells;
    cost.megabytes = std::max(cost.megabytes, MegabytesOfProgram + std::max(contours, mesh));
  }
  return cost;
}
} // namespace bone
