/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRImageFilter_h
#define boneDRRImageFilter_h

#include "boneDRRParameters.h"
#include "boneDensityMesh.h"
#include "boneProjectionModel.h"
#include "boneRadiographSource.h"

#include <memory>

namespace bone
{
/** The points of a mesh in double precision. */
template <typename TMesh>
std::vector<Vector3>
CopyPoints(const TMesh & mesh)
{
  std::vector<Vector3> points(mesh.GetNumberOfPoints());
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    const auto & x = mesh.GetPoints()->ElementAt(p);
    points[p] = Vector3(x[0], x[1], x[2]);
  }
  return points;
}

/** \class DRRImageFilter
 * \brief Digitally reconstructed radiograph of a tetrahedral density model (paper 5).
 *
 * Every pixel is the exact line integral of the piecewise polynomial density between source and pixel. Inputs: the mesh
 * (primary), with a density of any degrees 0..8, convex or not; "Geometry", see RadiographSource, which also describes
 * the output. The source may lie inside the mesh. Bone beyond the detector does not count.
 *
 * Parameters: \ref DRRParameters, HUToAttenuation (None or WaterScaled) and WaterAttenuation. A mesh without regions
 * cannot be restricted to some. Without conversion a density below 0 HU (fat, marrow) counts negative. WaterScaled is
 * linear, so that the density is not cut off below -1000 HU, and needs a density in HU (or of unknown quantity).
 *
 * Refused: a mesh without density, with coefficients or points that are not finite,
 * or without tetrahedra.
 *
 * The ProjectionModel is kept from one update to the next while the mesh and the parameters are the same:
 * about 200 bytes a tetrahedron of degree 3; further views then take some three quarters of the time.
 *
 * \sa MeshRadiograph for the method, VoxelDRRImageFilter for a CT */
template <typename TMesh = DensityMesh<double>, typename TOutputImage = itk::Image<float, 3>>
class DRRImageFilter : public RadiographSource<TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DRRImageFilter);
  using Self = DRRImageFilter;
  using Superclass = RadiographSource<TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DRRImageFilter, RadiographSource);

  using MeshType = TMesh;

  using Superclass::SetInput;
  virtual void
  SetInput(const TMesh * mesh)
  {
    this->itk::ProcessObject::SetNthInput(0, const_cast<TMesh *>(mesh));
  }
  const TMesh *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
  }

  using Superclass::SetParameters;
  BONE_PLAIN_FILTER_PARAMETERS(DRRParameters, BONE_REGION_RANGE_PARAMETERS)

protected:
  DRRImageFilter();
  ~DRRImageFilter() override = default;

  MeshRadiographParameters
  GetMeshRadiographParameters() const;
  /** The mesh as ProjectMesh takes it, made anew where mesh or parameters have changed. */
  const ProjectionModel &
  GetModel(const Execution & execution);
  /** The mesh's points; throws where no radiograph can be made of it. */
  std::vector<Vector3>
  GetVerifiedPoints() const;

  void
  ComputeIntegrals(const std::vector<XRayGeometry::View> & views,
                   const Execution &                       execution,
                   const std::vector<float *> &            integrals) override;

private:
  /** The model that GetModel keeps, and the mesh and conversion of which it was made. */
  struct Kept
  {
    const TMesh *                          mesh{ nullptr };
    itk::ModifiedTimeType                  time{ 0 };
    HUToAttenuation                        conversion{ HUToAttenuation::None };
    std::vector<Vector3>                   points;
    std::unique_ptr<const ProjectionModel> model;
  };
  Kept m_Kept;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDRRImageFilter.hxx"
#endif

#endif
