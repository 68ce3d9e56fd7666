/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePopulation_h
#define bonePopulation_h

#include "boneAtlasRegistrationFilter.h"
#include "boneImageIO.h"
#include "boneMeshIO.h"

#include <string>
#include <vector>

namespace bone
{
/** One subject of a population: its bone as a mesh or a closed surface, and its CT where its density is to be fitted.
 */
struct SubjectFiles
{
  std::string name;  ///< of the shape's file, without extension, and of its folders where files have one name
  std::string shape; ///< .vtu, or .ply, .vtp, .stl
  std::string ct;    ///< empty: none
};

/** Reads a list of subjects, one a line: the shape's file, and after a comma that of the CT where there is one. Names
 * are relative to the list's folder; empty lines and those that begin with # are passed over. Throws IOError, also
 * where there are fewer than `least`. */
std::vector<SubjectFiles>
ReadSubjectList(const std::string & path, std::size_t least = 2);

/** Reads every file once, as registration takes hours. Throws IOError where one cannot be used. */
void
VerifySubjects(const std::vector<SubjectFiles> & subjects);

/** The density of a model at the sample points of another mesh's cells, fitted there with one degree. Each cell takes
 * the density of its own region, that of the nearest place in it where the point lies in another or outside the model:
 * what belongs to a layer stays in it where the layers' surfaces differ by a little. A region that the model does not
 * have takes what is there. The mesh's density is replaced. Throws itk::ExceptionObject where the model has no density.
 */
void
FitDensityOfModel(const MeshArrays & model, int degree, MeshArrays & mesh);

/** The mesh with its density fitted to a CT, interpolated by cubic splines: linear interpolation blurs a thin cortex
 * and takes mass out of the bone. */
MeshArrays
FitDensityOfImage(const CTImage * ct, int degree, const MeshArrays & mesh);

/** \class PopulationRegistration
 * \brief Brings subjects onto the topology of a standard model, with their densities (paper 6.1): registration, then
 * the density fit. */
class PopulationRegistration
{
public:
  PopulationRegistration(DensityMesh<double>::Pointer standard, int degree);

  /** The filter that registers, for its parameters and what the last run did. */
  AtlasRegistrationFilter<> *
  GetFilter()
  {
    return m_Register;
  }

  /** The standard model on the subject. A mesh that has the standard's tetrahedra is taken as it is; others are
   * registered. Density comes from the CT, or else from the subject's own mesh; a surface alone has none. For a
   * mirrored subject the result lies in the reflected space. A mesh's layers are registered too. */
  MeshArrays
  Bring(const SubjectFiles & subject);

  /** The same for a surface and a CT in memory; no CT: no density. */
  MeshArrays
  Bring(const TriangleSurface & surface, const CTImage * ct);

  /** The same for a mesh in memory. */
  MeshArrays
  Bring(MeshArrays own, const CTImage * ct);

  /** Whether the last subject had to be registered. */
  bool
  WasRegistered() const
  {
    return m_Registered;
  }

private:
  /** Runs the registration, and fits the density of the CT, or else that of the subject's own mesh, if there is one. */
  MeshArrays
  Register(const MeshArrays * own, const CTImage * ct);

  DensityMesh<double>::Pointer       m_Standard;
  int                                m_Degree;
  AtlasRegistrationFilter<>::Pointer m_Register;
  bool                               m_Registered{ false };
};
} // namespace bone

#endif
