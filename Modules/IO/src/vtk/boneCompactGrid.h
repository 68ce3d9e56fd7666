/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCompactGrid_h
#define boneCompactGrid_h

#include "boneConversions.h"

namespace bone
{
/** Throws itk::ExceptionObject where an attribute is not of full length, an id is out of range, or a number is not
 * finite. */
void
RequireConsistent(const MeshArrays & mesh);

/** \brief The mesh with a density in the compact form: `DensityCodes` and `DensityScale` in place of coefficients,
 * without what is made anew on reading, whole numbers in the fewest bytes, and points in single precision where the
 * mesh stays as sound with them.
 *
 * The density changes by no more than `error` anywhere, as a Bernstein polynomial is a mean of its coefficients; 0:
 * by what 16 bits leave of each region's range. Throws itk::ExceptionObject where the mesh has no density, an attribute
 * is not of full length, or 16 bits are too few. */
vtkSmartPointer<vtkUnstructuredGrid>
ToCompactGrid(const MeshArrays & mesh, double error);

/** Degrees and coefficients from a grid in the compact form, whose tetrahedra and regions `mesh` has; nothing where it
 * is in another. Throws itk::ExceptionObject where the arrays are not consistent. */
void
ReadCompactDensity(vtkUnstructuredGrid * grid, MeshArrays & mesh);
} // namespace bone

#endif
