/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasVolumeRegistration_h
#define boneAtlasVolumeRegistration_h

#include "boneDensityMesh.h"
#include "boneMeshSource.h"
#include "boneStatisticalModel.h"
#include "boneVolumeRegistration.h"

#include <itkImage.h>

namespace bone
{
/** \class AtlasVolumeRegistration
 * \brief Finds an atlas' bone in a CT without a label map: mesh, density and label map (paper 1, 7).
 *
 * Inputs:
 * - "Image" (primary): a CT in HU, whose geometry (origin, spacing, direction) is honoured;
 * - "Model": a \ref StatisticalModel with a density in HU.
 *
 * Outputs:
 * - the bone found, a \ref DensityMesh of the atlas' topology (reflected where GetResult().mirrored) in the CT's space,
 * mm, with the density of the CT in polynomials of the atlas' degree; tetrahedra beyond the CT keep that of the mean;
 * - a label map on the CT's grid: the region (1 cortical, 2 trabecular, 3 medullary cavity; 1 in an atlas without
 * regions) of the tetrahedron at each voxel centre, 0 elsewhere: GetLabelImage(). GetResult() has pose, coefficients,
 * covariance, support and quality.
 *
 * Parameters: \ref AtlasVolumeParameters. Method: RegisterVolume. The same result for any number of threads.
 *
 * Throws itk::ExceptionObject where an input is missing or empty, the atlas has no density in HU or fewer than four
 * subjects, tetrahedra cannot be repaired, and where the bone is not found: quality Failed is an error, not a guess.
 *
 * \tparam TImage a three-dimensional image of a scalar pixel type \tparam TMesh a \ref DensityMesh
 * \tparam TLabelImage a three-dimensional image of an integer pixel type */
template <typename TImage = itk::Image<float, 3>,
          typename TMesh = DensityMesh<double>,
          typename TLabelImage = itk::Image<short, 3>>
class AtlasVolumeRegistration : public MeshSource<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(AtlasVolumeRegistration);
  using Self = AtlasVolumeRegistration;
  using Superclass = MeshSource<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(AtlasVolumeRegistration, MeshSource);

  using ImageType = TImage;
  using LabelImageType = TLabelImage;
  static_assert(TImage::ImageDimension == 3 && TLabelImage::ImageDimension == 3, "Images must be three-dimensional.");

  itkSetInputMacro(Image, TImage);
  itkGetInputMacro(Image, TImage);
  itkSetInputMacro(Model, StatisticalModel);
  itkGetInputMacro(Model, StatisticalModel);

  BONE_FILTER_PARAMETERS(AtlasVolumeParameters, BONE_ATLAS_VOLUME_PARAMETERS)

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override
  {
    if (index == 0)
    {
      return TMesh::New().GetPointer();
    }
    return TLabelImage::New().GetPointer();
  }
  TLabelImage *
  GetLabelImage()
  {
    return static_cast<TLabelImage *>(this->itk::ProcessObject::GetOutput(1));
  }
  /** What the last update found; its mesh is in the output. */
  itkGetConstReferenceMacro(Result, VolumeRegistrationResult);

protected:
  AtlasVolumeRegistration();
  ~AtlasVolumeRegistration() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateOutputInformation() override
  {}
  void
  EnlargeOutputRequestedRegion(itk::DataObject * output) override
  {
    output->SetRequestedRegionToLargestPossibleRegion();
  }
  void
  GenerateInputRequestedRegion() override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  void
  VerifyInputs() const;
  /** Fits the density of the mesh found. */
  void
  FitDensity(const VolumeView & ct);
  void
  FillLabels(const VoxelGrid & grid, const Execution & execution);

  VolumeRegistrationResult m_Result;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneAtlasVolumeRegistration.hxx"
#endif

#endif
