/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneConversions_h
#define boneConversions_h

#include "boneDensityMesh.h"

#include <itkMesh.h>

#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

namespace bone
{
/** Names of the arrays of a density mesh in a vtkUnstructuredGrid and in .vtu files; types, number of components and
 * meaning: see the table in the module's README. */
namespace ArrayNames
{
constexpr const char * Region = "Region";
constexpr const char * Layer = "Layer";
constexpr const char * Slice = "Slice";
constexpr const char * Degree = "Degree";
constexpr const char * DensityCoefficients = "DensityCoefficients";
constexpr const char * FaceNeighbors = "FaceNeighbors";
constexpr const char * DensityQuantity = "DensityQuantity";
constexpr const char * DensityCodes = "DensityCodes";
constexpr const char * DensityScale = "DensityScale";
constexpr const char * MeanDensity = "MeanDensity";
constexpr const char * Density = "Density";
} // namespace ArrayNames

using ItkMesh = itk::Mesh<double, 3>;

/** \defgroup Conversions Between density meshes and VTK's and ITK's meshes
 * All are deep copies.
 * \{ */

/** Points in double, linear tetrahedra, and the arrays named above as far as the mesh has them; with a density also
 * `MeanDensity`, the exact mean over each tetrahedron, as the active scalars, and `Density`, the value at each point
 * within the innermost region that meets there. Throws itk::ExceptionObject where an attribute is not
 * of full length. */
vtkSmartPointer<vtkUnstructuredGrid>
ToVtkUnstructuredGrid(const MeshArrays & mesh);

template <typename TCoordinate>
vtkSmartPointer<vtkUnstructuredGrid>
ToVtkUnstructuredGrid(const DensityMesh<TCoordinate> * mesh)
{
  return ToVtkUnstructuredGrid(mesh->GetArrays());
}

/** The inverse, of the compact form too. Every array is optional and may have any numeric type: without `Degree` all tetrahedra have the degree
 * that the number of coefficients implies; missing face neighbours are computed. Throws itk::ExceptionObject with one
 * line where a cell is no linear tetrahedron (it says which types there are, and how many), an id is out of range, or
 * an array's width, length or values cannot be. */
MeshArrays
ToMeshArrays(vtkUnstructuredGrid * grid);

/** Points and tetrahedra; each cell's data is its region (0 where the mesh has none), each point's its layer. */
ItkMesh::Pointer
ToItkMesh(const MeshArrays & mesh);

template <typename TCoordinate>
ItkMesh::Pointer
ToItkMesh(const DensityMesh<TCoordinate> * mesh)
{
  return ToItkMesh(mesh->GetArrays());
}

/** Points and tetrahedra, and regions and layers from cell and point data where there are any for all. Throws
 * itk::ExceptionObject at any other kind of cell. Point identifiers become consecutive, in their order. */
MeshArrays
ToMeshArrays(const ItkMesh * mesh);
/** \} */
} // namespace bone

#endif
