/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBoundaryFit_h
#define boneBoundaryFit_h

#include "boneDeformableModel.h"
#include "boneRigidPose.h"
#include "boneTriangleSurface.h"
#include "boneVolumeRegistration.h"

namespace bone
{
/** Where a bone is, and its shape: standard deviations of a model's modes of shape, then of its smooth ones. */
struct VolumeState
{
  RigidPose       pose;
  Eigen::VectorXd coefficients;
};

/** What the CT says of a surface point. */
struct BoundaryTarget
{
  bool   visible{ false }; ///< the CT shows where the point is
  double offset{ 0.0 };    ///< of the edge found along the outward normal, mm
  double weight{ 0.0 };    ///< 0: no edge; 1: a clear one
};

/** A place along an outward normal at which density falls from bone's to less, within `range` mm of `x`: the clearest
 * and nearest, where one beyond another that leads out of a bone counts less. The edge lies where the density is
 * half-way between the highest just inside and the least just outside. */
BoundaryTarget
FindBoundary(const VolumeView & ct, const Vector3 & x, const Vector3 & outward, double range, double boneThreshold);

/** \class BoundaryFit
 * \brief Brings an atlas' surface onto the edges of a CT: pose and modes by steps of weighted least squares.
 *
 * Each step looks for edges along the surface's normals (\ref FindBoundary) and solves for the most probable pose and
 * coefficients: prior of the coefficients standard normal, distances from the edges normal with a deviation that is
 * their own (median absolute deviation), Tukey's weights. An active shape model (T. F. Cootes et al.,
 * doi:10.1006/cviu.1995.1004) with the smooth modes of a Gaussian process beside those of the subjects. */
class BoundaryFit
{
public:
  static constexpr double Near = 1.0; ///< mm

  BoundaryFit(const DeformableModel & model, const VolumeView & ct, double boneThreshold);

  /** A step with edges sought within `range` mm and the first `modes` modes; the others stay. */
  void
  Step(VolumeState & state, double range, Eigen::Index modes, const Execution & execution);

  /** Moves each of the surface's points along its normal onto the edges, as a smooth field of offsets: what modes
   * leave. */
  std::vector<Vector3>
  Settle(std::vector<Vector3> points, double range, const Execution & execution) const;

  /** How well the surface lies on edges; `unsupported`, unless null, takes its connected parts that do not. */
  BoundarySupport
  Judge(const std::vector<Vector3> &    points,
        const Execution &               execution,
        std::vector<UnsupportedPatch> * unsupported = nullptr) const;

  /** Of pose and coefficients, at the last step. */
  const Eigen::MatrixXd &
  GetHessian() const
  {
    return m_Hessian;
  }

  std::vector<Vector3>
  Points(const VolumeState & state) const;
  const std::vector<IdType> &
  Exterior() const
  {
    return m_Exterior;
  }
  std::vector<BoundaryTarget>
  FindTargets(const std::vector<Vector3> & points,
              double                       range,
              std::vector<Vector3> &       normals,
              const Execution &            execution) const;

private:
  std::vector<UnsupportedPatch>
  FindPatches(const std::vector<Vector3> & points, std::vector<bool> left, double visible) const;

  const DeformableModel &               m_Model;
  const VolumeView &                    m_Image;
  double                                m_BoneThreshold;
  std::vector<IdType>                   m_Exterior;
  TriangleSurface                       m_Surface;
  std::vector<std::vector<std::size_t>> m_Neighbors; ///< of the surface's points
  Eigen::MatrixXd                       m_Hessian;
};
} // namespace bone

#endif
