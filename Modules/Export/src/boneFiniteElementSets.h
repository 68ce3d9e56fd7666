/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFiniteElementSets_h
#define boneFiniteElementSets_h

#include "boneFiniteElementModel.h"

namespace bone
{
/** Fills nodeSets, elementSets and exterior of a model that has its nodes, elements, regions and materials. `mesh` has
 * neighbours and regions. Throws std::invalid_argument; see MakeFiniteElements. */
void
AddFiniteElementSets(const MeshArrays & mesh, const std::vector<Landmark> & landmarks, FiniteElementModel & model);
} // namespace bone

#endif
