/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasRegistrationFilter_h
#define boneAtlasRegistrationFilter_h

#include "boneAtlasRegistration.h"
#include "boneDensityMesh.h"
#include "boneMeshSource.h"

#include <itkSimpleDataObjectDecorator.h>

namespace bone
{
/** \class AtlasRegistrationFilter
 * \brief Carries a standard model to a subject: same topology, the subject's shape (paper 6.1).
 *
 * Inputs: the standard model, a mesh of positive tetrahedra, and the subject, either a mesh, whose exterior surface and
 * surfaces between layers are taken, or a closed surface (SetSubjectSurface). Output: the standard model's tetrahedra,
 * layers, slices and regions on points that lie on the subject; no density, which is fitted after (DensityFitFilter).
 *
 * 1. Alignment by principal axes and iterative closest points, affine by default.
 * 2. The exterior surface is deformed: adaptive focus (D. Shen et al.,
 *    doi:10.1109/42.921475; default) or non-rigid ICP,
 *    then its facets are laid on the subject.
 * 3. Interior points follow: a harmonic displacement (default) or the paper's eigen-frames.
 *    Then the surfaces between layers are laid on the subject's, if it is a layered mesh and FitLayers is on (default).
 * 4. Inverted tetrahedra are repaired within bounds (\ref UntangleMesh). If some are left, the filter throws and says
 *    how many: no inverted tetrahedron leaves it.
 *
 * Mirror: Never (default), Always, or Try: the subject is reflected at x = 0 first, and the output lies in the
 * reflected space (GetReport().mirrored); ReflectPoints brings points back.
 *
 * Parameters: \ref AtlasRegistrationParameters. Results do not depend on the number of threads. Throws
 * itk::ExceptionObject. */
template <typename TMesh = DensityMesh<double>>
class AtlasRegistrationFilter : public MeshSource<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(AtlasRegistrationFilter);
  using Self = AtlasRegistrationFilter;
  using Superclass = MeshSource<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(AtlasRegistrationFilter, MeshSource);

  using MeshType = TMesh;
  using SurfaceType = itk::SimpleDataObjectDecorator<TriangleSurface>;

  itkSetInputMacro(Standard, TMesh);
  itkGetInputMacro(Standard, TMesh);
  /** The subject is what was set last: a mesh or a surface. */
  void
  SetSubject(const TMesh * mesh);
  itkGetInputMacro(Subject, TMesh);
  void
  SetSubjectSurface(const TriangleSurface & surface);

  BONE_FILTER_PARAMETERS(AtlasRegistrationParameters, BONE_ATLAS_REGISTRATION_PARAMETERS)

  /** What the last run did. */
  itkGetConstReferenceMacro(Report, RegistrationReport);

protected:
  AtlasRegistrationFilter();
  ~AtlasRegistrationFilter() override = default;
  void
  VerifyPreconditions() const override;
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  SubjectSurfaces
  TakeSubject() const;

  RegistrationReport             m_Report;
  std::unique_ptr<StandardModel> m_Standard; // of the standard it was made of, for a population of subjects
  itk::ModifiedTimeType          m_StandardTime{ 0 };
};

extern template class AtlasRegistrationFilter<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneAtlasRegistrationFilter.hxx"
#endif

#endif
