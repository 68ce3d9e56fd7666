/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLevelDensity_h
#define boneLevelDensity_h

#include "boneBernstein.h"
#include "boneDensitySamples.h"

#include <functional>
#include <vector>

namespace bone
{
/** Runs a body for every index 0..n-1, perhaps in parallel. */
using ParallelFor = std::function<void(std::size_t n, const std::function<void(std::size_t)> & body)>;

/** \brief Gives a level its density: cells that did not change keep theirs, the others are fitted to the level before.
 *
 * \param before      the level before, with density.
 * \param level       the new level; degree, coefficients and quantity are written.
 * \param parentCell  for each cell of \a level its cell in \a before if it did not change, otherwise -1.
 * \param cellSlot    for each cell of \a level its slot in \a samples.
 * \param sampleCell  for each sample its cell in \a before: where the search begins.
 * Changed cells get the largest degree of the mesh; a point of theirs outside the level before has the density of the
 * nearest place of its boundary. The same result for any number of threads. */
void
RefitDensity(const MeshArrays &          before,
             MeshArrays &                level,
             const std::vector<IdType> & parentCell,
             const std::vector<IdType> & cellSlot,
             const DensitySamples &      samples,
             const std::vector<IdType> & sampleCell,
             const ParallelFor &         parallelFor);

/** Root mean square difference of a level's density to the samples of the finest, in density units. */
double
DensityError(const MeshArrays &          level,
             const std::vector<IdType> & cellSlot,
             const DensitySamples &      samples,
             const ParallelFor &         parallelFor);
} // namespace bone

#endif
