/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVtkFile_h
#define boneVtkFile_h

#include "boneFileName.h"
#include "boneMeshArrays.h"
#include "boneMeshStorageParameters.h"

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>

#include <string>
#include <vector>

namespace bone
{
class AtomicFile;

/** Throws IOError unless the path ends (in any case) in one of the extensions, given with their dots. */
void
RequireExtension(const std::string & path, const std::vector<std::string> & extensions);

/** Read a file with VTK's reader; VTK's own messages become one IOError. */
vtkSmartPointer<vtkUnstructuredGrid>
ReadVtuFile(const std::string & path);
vtkSmartPointer<vtkPolyData>
ReadVtpFile(const std::string & path);
vtkSmartPointer<vtkPolyData>
ReadStlFile(const std::string & path);

/** Points and faces of a PLY file; other elements and properties are passed over. Throws itk::ExceptionObject. */
vtkSmartPointer<vtkPolyData>
ReadPlyFile(const std::string & path);

/** The root element of an XML file, or null where it is none. */
vtkSmartPointer<vtkXMLDataElement>
ReadXmlFile(const std::string & path);

/** Whether a file is compressed quickly or well. */
enum class FileSize : int
{
  Quick,
  Small
};

/** Write a .vtu or .vtp file to the temporary path, without committing. */
void
WriteVtuFile(vtkUnstructuredGrid * grid, AtomicFile & file, FileSize size = FileSize::Quick);
/** The same of a density mesh. Throws itk::ExceptionObject where it is not consistent. */
void
WriteMeshFile(const MeshArrays & mesh, const MeshStorageParameters & storage, AtomicFile & file);
void
WriteVtpFile(vtkPolyData * data, AtomicFile & file);
} // namespace bone

#endif
