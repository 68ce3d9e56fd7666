/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTilingMetric_h
#define boneTilingMetric_h

#include "boneTilingParameters.h"
#include "boneTypes.h"

#include <functional>
#include <memory>

namespace bone
{
/** One step of the knit between two slices (paper 2.2): the cross-section of the ring that it leads to. */
struct TilingStep
{
  int                    numberOfEdges{ 0 };
  std::array<Vector3, 4> edges; ///< end points of the (at most two) edges between the slices, pairwise
  int                    numberOfFaces{ 0 };
  std::array<Vector3, 6> faces;         ///< corners of the (at most two) faces across the ring, three by three
  double                 volume{ 0.0 }; ///< mm^3 added
};

/** \class TilingMetric
 * \brief Cost of a step of the knit; the tiling minimises its sum (paper 2.3).
 *
 * Derive from it to add a metric of your own. `Evaluate` is called from several threads at once. */
class TilingMetric
{
public:
  virtual ~TilingMetric() = default;
  virtual double
  Evaluate(const TilingStep & step) const = 0;
};

/** Density at a physical point (mm), in the units of the image; may return NaN where the image ends. */
using DensitySampler = std::function<double(const Vector3 &)>;

/** Minimum total length of the edges between the slices (mm). */
class SpanLengthMetric : public TilingMetric
{
public:
  double
  Evaluate(const TilingStep & step) const override;
};

/** Minimum total area of the faces across the rings (mm^2). */
class AreaMetric : public TilingMetric
{
public:
  double
  Evaluate(const TilingStep & step) const override;
};

/** Maximum volume: minus the volume added (mm^3). */
class VolumeMetric : public TilingMetric
{
public:
  double
  Evaluate(const TilingStep & step) const override;
};

/** Minimum deviation of density along the new edges: length times standard deviation (mm x density units). */
class DensityDeviationMetric : public TilingMetric
{
public:
  explicit DensityDeviationMetric(DensitySampler sampler);
  double
  Evaluate(const TilingStep & step) const override;

private:
  DensitySampler m_Sampler;
};

/** Span length plus `weight` times density deviation; the default of the paper. With a weight of 1/500 a deviation of
 * 500 HU along an edge counts as much as its length. Without a sampler it is span length alone. */
class CombinedMetric : public TilingMetric
{
public:
  explicit CombinedMetric(DensitySampler sampler, double weight = 1.0 / 500.0);
  double
  Evaluate(const TilingStep & step) const override;

private:
  SpanLengthMetric                        m_Span;
  std::unique_ptr<DensityDeviationMetric> m_Density;
  double                                  m_Weight;
};

/** Throws std::invalid_argument where the kind is Density and there is no sampler. */
std::shared_ptr<const TilingMetric>
MakeTilingMetric(TilingMetricKind kind, const DensitySampler & sampler);
} // namespace bone

#endif
