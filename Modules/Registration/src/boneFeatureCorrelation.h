/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFeatureCorrelation_h
#define boneFeatureCorrelation_h

#include "boneVolumeSearch.h"

namespace bone
{
/** An edge of dense bone. */
struct VolumeEdge
{
  Vector3 point;
  Vector3 normal;                     ///< unit, towards less density
  Vector3 leading{ Vector3::Zero() }; ///< how the model's first mode of shape moves it
};

/** Where a map of \ref BoneLikeness falls by a tenth or more from voxel to voxel. */
std::vector<VolumeEdge>
FindEdges(const VoxelVolume & volume);

/** \class FeatureCorrelation
 * \brief How well the model's map of \ref BoneLikeness agrees with that of a CT at one resolution. */
class FeatureCorrelation
{
public:
  /** `samples` of the model at the most, in the bone and one voxel about it; `modes` of shape. */
  FeatureCorrelation(const DeformableModel & model,
                     const VolumeView &      ct,
                     double                  spacing,
                     double                  softTissue,
                     std::size_t             samples,
                     Eigen::Index            modes,
                     const Execution &       execution);

  /** Edges of the model's map and of the CT's. */
  const std::vector<VolumeEdge> &
  ModelEdges() const
  {
    return m_ModelEdges;
  }
  const std::vector<VolumeEdge> &
  ImageEdges() const
  {
    return m_ImageEdges;
  }

  /** Sets the correlation of the two maps at the samples, and the share of these in the CT. */
  void
  Correlate(VolumeCandidate & candidate) const;

  /** Sets the score by every `stride`th edge of the model: how much the CT's map falls across it, from -1 to 1 in the
   * mean of those that lie in the CT, times the root of their share. */
  void
  ScoreEdges(VolumeCandidate & candidate, std::size_t stride = 1) const;

  /** Gauss-Newton steps over pose and modes as long as they gain, `iterations` at the most. */
  void
  Refine(VolumeCandidate & candidate, int iterations) const;

private:
  Vector3
  Place(std::size_t sample, const VolumeCandidate & candidate) const;
  /** A step over pose and modes; false where there are too few samples. */
  bool
  FindStep(const VolumeCandidate & candidate, Eigen::VectorXd & step, double damping) const;
  /** What Refine raises: the log-likelihood of the correlation and the modes' prior. */
  static double
  Merit(const VolumeCandidate & candidate);

  VoxelVolume                       m_Image;
  std::vector<VolumeEdge>           m_ModelEdges;
  std::vector<VolumeEdge>           m_ImageEdges;
  std::vector<Vector3>              m_Points;
  std::vector<double>               m_Values;
  double                            m_EdgeStep;      ///< mm to each side of an edge
  std::vector<std::vector<Vector3>> m_Displacements; ///< of each mode at each sample
};
} // namespace bone

#endif
