/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef projector_h
#define projector_h

#include "objects.h"

#include "boneDRRParameters.h"
#include "boneMeshDerivatives.h"
#include "boneProjectionModel.h"
#include "boneRigidPose.h"

#include <memory>
#include <vector>

namespace bone::python
{
/** A rigid motion of a model by six numbers, translation t (mm) and rotation vector r (radians), and what derivatives
 * by them are: x -> R(r) (x - centre) + centre + t. */
class PoseParameters
{
public:
  PoseParameters(const Eigen::Matrix<double, 6, 1> & numbers, const Vector3 & centre);
  const RigidPose &
  GetPose() const
  {
    return m_Pose;
  }
  /** Six by six: derivatives by t and r from those by a small motion of the model in its own space (RadiographModes).
   */
  const Eigen::Matrix<double, 6, 6> &
  GetChain() const
  {
    return m_Chain;
  }

private:
  RigidPose                   m_Pose;
  Eigen::Matrix<double, 6, 6> m_Chain;
};

/** \class Projector
 * \brief Radiographs of one density model from many views and in many poses, with their derivatives. */
class Projector : public std::enable_shared_from_this<Projector>
{
public:
  /** Throws UsageFailure where no radiograph can be made of the mesh. */
  Projector(const Mesh & mesh, const DRRParameters & regions, const RadiographParameters & conversion, bool keep);

  /** Poses x rows x columns line integrals. */
  py::array_t<float>
  Project(const XRayGeometry & geometry, const std::vector<PoseParameters> & poses) const;
  /** The radiograph, and its derivatives: modes x rows x columns. */
  py::tuple
  Derive(const XRayGeometry & geometry, const PoseParameters & pose, RadiographModes modes) const;
  /** Derivatives of the sum of image * radiograph: of the pose, the points and the coefficients. */
  py::dict
  Backproject(const XRayGeometry::View & view, const PoseParameters & pose, const Array<float> & image) const;

  const Vector3 &
  GetCentre() const
  {
    return m_Centre;
  }
  const MeshArrays &
  GetArrays() const
  {
    return m_Arrays;
  }

private:
  MeshArrays                             m_Arrays;
  MeshRadiographParameters               m_Parameters;
  Vector3                                m_Centre; // mean of the points
  std::unique_ptr<const ProjectionModel> m_Model;
};

void
BindGeometry(py::module_ & m);
void
BindProjector(py::module_ & m);
} // namespace bone::python

#endif
