/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFlatCut_h
#define boneFlatCut_h

#include "boneMeshArrays.h"

namespace bone
{
/** \struct FlatCut
 * \brief A flat end of a model, where the bone leaves the CT. */
struct FlatCut
{
  Vector3 inward{ Vector3::UnitZ() }; ///< unit normal, into the bone
  double  offset{ 0.0 };              ///< inward . x of the points on the cut, mm
};

/** The flat ends of a model: planes on which its exterior has more than half of the mean section of the 10 mm beneath
 * them. An end that a bone has by nature is round, and flat over a small part of that section. */
std::vector<FlatCut>
FindFlatCuts(const MeshArrays & mesh);

/** Multiplies the density with the distance to each cut over `length` (mm), 1 from there on, at the control points of
 * the polynomials: no edge is left where the model ends. */
void
FadeToCuts(MeshArrays & mesh, const std::vector<FlatCut> & cuts, double length);
/** \brief The levels of a model (fine to coarse), with a density that fades over `length` (mm) to the flat cuts of the
 * first; 0: as they are. */
std::vector<MeshArrays>
FadeFlatCuts(std::vector<MeshArrays> levels, double length);
} // namespace bone

#endif
