/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshIO_h
#define boneMeshIO_h

#include "boneDensityMesh.h"
#include "boneMeshStorageParameters.h"
#include "boneTriangleSurface.h"

#include <array>
#include <string>
#include <variant>
#include <vector>

class vtkUnstructuredGrid;

namespace bone
{
/** \defgroup MeshIO Density meshes in VTK's unstructured-grid format (.vtu)
 *
 * Arrays and their types: see the table in the module's README. Files hold points in double and inline base64 data
 * compressed by zlib. All functions throw IOError: one line that names the file and what is wrong.
 * \{ */

/** Reads a tetrahedral mesh with or without any of the arrays. Refuses a missing, empty or broken file, cells that are
 * no linear tetrahedra, ids out of range, coordinates and coefficients that are not finite, and arrays of the wrong
 * width. */
MeshArrays
ReadMeshArrays(const std::string & path);

/** Writes the whole file or none. The name must end in .vtu. In the compact form, which needs a density, what is made
 * anew on reading is left out, and numbers are rounded: see the README. Throws IOError where the error that is asked
 * for needs more than 16 bits. */
void
WriteMeshArrays(const MeshArrays & mesh, const std::string & path, const MeshStorageParameters & storage = {});

/** Any grid, as WriteMeshArrays. */
void
WriteUnstructuredGrid(vtkUnstructuredGrid * grid, const std::string & path);

DensityMesh<double>::Pointer
ReadDensityMesh(const std::string & path);

template <typename TCoordinate>
void
WriteDensityMesh(const DensityMesh<TCoordinate> * mesh,
                 const std::string &              path,
                 const MeshStorageParameters &    storage = {})
{
  WriteMeshArrays(mesh->GetArrays(), path, storage);
}
/** \} */

/** Reads a .ply, .vtp or .stl surface; polygons are cut into triangles, and a surface whose triangles look inward is
 * turned. Throws IOError where it is missing, broken, empty, not closed (an edge has not two triangles that run along
 * it in opposite directions) or has coordinates that are not finite. */
TriangleSurface
ReadTriangleSurface(const std::string & path);

/** Values at the points of a surface, of doubles or ints. */
struct PointArray
{
  std::string                                         name;
  std::variant<std::vector<double>, std::vector<int>> values;
};

/** Writes the whole surface with its point data, the first array as the active scalars, or none; a .vtp file. Throws
 * IOError, also where an array has not one value for each point. */
void
WriteTriangleSurface(const TriangleSurface & surface, const std::vector<PointArray> & arrays, const std::string & path);
} // namespace bone

#endif
