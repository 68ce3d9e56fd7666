/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFiniteElementIO_h
#define boneFiniteElementIO_h

#include "boneFiniteElementModel.h"

namespace bone
{
/** What a solver or a viewer reads. */
enum class FiniteElementFormat : int
{
  Abaqus = 0,   ///< .inp: nodes, elements, sets, materials; no step, so that it can be included
  CalculiX = 1, ///< the same keywords
  FEBio = 2,    ///< .feb, version 4: mesh, sets, materials; no step
  Gmsh = 3,     ///< .msh, version 4.1: physical groups for the sets, moduli as element and node data
  VTK = 4       ///< .vtu: moduli and sets as arrays
};

template <>
struct ParameterChoices<FiniteElementFormat>
{
  static constexpr std::array<const char *, 5> names = { "abaqus", "calculix", "febio", "gmsh", "vtk" };
};

/** The ending of the format's file names, with its dot. */
const char *
FiniteElementExtension(FiniteElementFormat format);

/** Whether the format can hold a modulus that is constant over that. */
bool
HoldsModulusField(FiniteElementFormat format, ModulusField field);

/** \brief Writes a model; the whole file or none.
 *
 * Lengths in mm, forces in N, moduli in MPa, mass density in t/mm^3; nodes and elements are numbered from 1 (in VTK
 * from 0) in the model's order. Sets have their own names in every format. In gmsh the node sets are groups of points,
 * EXTERIOR one of triangles, and an element belongs to the groups of its region and its material. With moduli by node
 * Abaqus and CalculiX read them in GPa as the initial temperature, on which the only material depends, without any
 * expansion; with moduli by cell FEBio reads them from a map.
 *
 * Throws IOError where the file cannot be written or has another extension, and std::invalid_argument where the format
 * cannot hold such moduli. */
void
WriteFiniteElements(const FiniteElementModel & model, FiniteElementFormat format, const std::string & path);
} // namespace bone

#endif
