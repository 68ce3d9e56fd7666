/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformableCost.h"

#include "boneIntensityDifference.h"
#include "boneOutwardMove.h"
#include "bonePatchGradientCorrelation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
/** A weight of 1 within `radius` pixels, along columns and rows, of where the image is above 0. */
std::vector<float>
Surroundings(const std::vector<float> & image, const std::array<int, 2> & size, int radius)
{
  std::vector<float> along(image.size(), 0.0f), both(image.size(), 0.0f);
  for (int r = 0; r < size[1]; ++r)
  {
    for (int c = 0; c < size[0]; ++c)
    {
      const std::size_t at = static_cast<std::size_t>(r) * size[0] + c;
      const auto        from = image.begin() + (at - std::min(radius, c));
      const auto        to = image.begin() + (at + std::min(radius, size[0] - 1 - c)) + 1;
      along[at] = std::any_of(from, to, [](float x) { return x != 0.0f; }) ? 1.0f : 0.0f;
    }
  }
  for (int r = 0; r < size[1]; ++r)
  {
    for (int y = std::max(0, r - radius); y <= std::min(size[1] - 1, r + radius); ++y)
    {
      for (int c = 0; c < size[0]; ++c)
      {
        float & weight = both[static_cast<std::size_t>(r) * size[0] + c];
        weight = std::max(weight, along[static_cast<std::size_t>(y) * size[0] + c]);
      }
    }
  }
  return both;
}
} // namespace

DeformableCost::DeformableCost(const DeformableModel &                model,
                               const std::vector<RadiographView> &    views,
                               const DeformableRadiographParameters & parameters,
                               int                                    pixels)
  : m_Model(model)
  , m_P(parameters)
  , m_Metrics(1)
{
  m_Modes.pose = true;
  m_Modes.shape = model.displacements;
  m_Modes.density = model.densities;
  m_Images.resize(views.size());
  m_Attenuation.scale = parameters.attenuationSlope;
  m_Attenuation.offset = -parameters.attenuationSlope * parameters.softTissue;
  const int patch = PatchAt(pixels, parameters);
  for (const RadiographView & view : views)
  {
    m_Views.push_back(ReduceView(view, ReductionTo(view.view, pixels)));
    try
    {
      m_Metrics[0].push_back(std::make_unique<PatchGradientCorrelation>(m_Views.back(), patch, parameters.sigma));
    }
    catch (const std::invalid_argument & error)
    {
      throw std::invalid_argument("View " + std::to_string(m_Views.size()) + ": " + error.what() + '.');
    }
  }
}

int
DeformableCost::PatchAt(int pixels, const DeformableRadiographParameters & parameters)
{
  return std::max(4, parameters.patch * pixels / parameters.pixels);
}

std::vector<std::vector<float>>
DeformableCost::Project(const std::vector<Vector3> & points,
                        const MeshCells &            cells,
                        const RigidPose &            pose,
                        const Execution &            execution) const
{
  std::vector<XRayGeometry::View> views;
  std::vector<std::vector<float>> images;
  std::vector<float *>            pointers;
  for (const RadiographView & view : m_Views)
  {
    views.push_back(pose.ToModelSpace(view.view));
    images.emplace_back(view.GetNumberOfPixels());
  }
  for (auto & image : images)
  {
    pointers.push_back(image.data());
  }
  ProjectMesh(points, cells, views, m_Attenuation, execution, pointers);
  return images;
}

void
DeformableCost::UseIntensities(const DeformableState & state, const Execution & execution)
{
  constexpr double margin = 0.25; // of the background's length
  constexpr double leastScale = 1e-3;
  constexpr double mostGain = 3.0; // a density so far from the atlas is none of this bone
  constexpr double anyGain = 1e6;
  const MeshArrays mesh = m_Model.Synthesize(state.coefficients);
  const auto       images = this->Project(mesh.points, mesh, state.pose, execution);
  m_Metrics.resize(2);
  m_Metrics[1].clear();
  for (std::size_t v = 0; v < m_Views.size(); ++v)
  {
    RadiographView view = m_Views[v];
    const double   length = m_P.backgroundLength / view.view.spacing[0];
    const auto     near = Surroundings(images[v], view.view.size, std::max(3, static_cast<int>(margin * length)));
    if (view.weights.empty())
    {
      view.weights = near;
    }
    for (std::size_t i = 0; i < near.size(); ++i)
    {
      view.weights[i] *= near[i];
    }
    IntensityDifferenceParameters parameters;
    parameters.knotSpacing = std::max(4.0, length);
    parameters.gainDeviation = m_P.gainDeviation;
    IntensityDifferenceParameters free = parameters;
    free.gainDeviation = anyGain;
    const double gain = IntensityDifference(view, free).GetGain(images[v].data());
    if (!(gain > 1.0 / mostGain && gain < mostGain))
    {
      throw std::invalid_argument("View " + std::to_string(v + 1) + ": its values are " + std::to_string(gain) +
                                  " times the line integrals of the bone found. Either they are no line integrals of "
                                  "attenuation: turn Intensities off to use their gradients alone. Or the bone was "
                                  "not found: give a nearer start, or a larger search.");
    }
    parameters.scale = std::max(leastScale, IntensityDifference(view, parameters).EstimateScale(images[v].data()));
    m_Metrics[1].push_back(std::make_unique<IntensityDifference>(view, parameters));
  }
}

std::vector<MetricSum>
DeformableCost::Evaluate(const DeformableState & state, const Execution & execution)
{
  const MeshArrays       mesh = m_Model.Synthesize(state.coefficients);
  const auto             count = static_cast<Eigen::Index>(m_Modes.Count());
  std::vector<MetricSum> totals(m_Metrics.size(), MetricSum(count));
  m_Modes.poseCentre = state.pose.centre;
  std::vector<std::vector<float *>> pointers(m_Views.size());
  for (std::size_t v = 0; v < m_Views.size(); ++v)
  {
    const std::size_t pixels = m_Views[v].GetNumberOfPixels();
    m_Images[v].resize(pixels * (1 + m_Modes.Count()));
    for (std::size_t i = 0; i <= m_Modes.Count(); ++i)
    {
      pointers[v].push_back(&m_Images[v][i * pixels]);
    }
    ProjectMeshDerivatives(
      mesh.points, mesh, state.pose.ToModelSpace(m_Views[v].view), m_Attenuation, m_Modes, execution, pointers[v]);
  }
  // Each metric of each view, the views of a metric one after the other.
  std::vector<MetricValue> values(m_Metrics.size() * m_Views.size());
  execution.For(values.size(), [&](std::size_t i) {
    const std::size_t v = i % m_Views.size();
    values[i] = m_Metrics[i / m_Views.size()][v]->EvaluateDerivatives(pointers[v]);
  });
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    totals[i / m_Views.size()].Add(values[i], 1.0 / static_cast<double>(m_Views.size()));
  }
  return totals;
}

std::vector<double>
DeformableCost::EvaluateCosts(const DeformableState & state, const Execution & execution) const
{
  const MeshArrays    mesh = m_Model.Synthesize(state.coefficients);
  const auto          images = this->Project(mesh.points, mesh, state.pose, execution);
  std::vector<double> values(m_Metrics.size() * m_Views.size());
  execution.For(values.size(), [&](std::size_t i) {
    const std::size_t v = i % m_Views.size();
    values[i] = m_Metrics[i / m_Views.size()][v]->Evaluate(images[v].data());
  });
  std::vector<double> costs(m_Metrics.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    costs[i / m_Views.size()] += values[i] / static_cast<double>(m_Views.size());
  }
  return costs;
}

std::vector<MetricSum>
DeformableCost::Evaluate(const DeformableState &        state,
                         std::vector<Eigen::VectorXd> & surfaceSlopes,
                         const Execution &              execution)
{
  m_Modes.shape.push_back(OutwardMove(m_Model.Synthesize(state.coefficients)));
  const auto values = this->Evaluate(state, execution);
  const auto densities = static_cast<Eigen::Index>(m_Modes.density.size());
  const auto surface = static_cast<Eigen::Index>(m_Modes.Count()) - densities - 1;
  m_Modes.shape.pop_back();
  std::vector<MetricSum> rest;
  surfaceSlopes.clear();
  for (const MetricSum & value : values)
  {
    rest.push_back(value.Without(surface));
    surfaceSlopes.emplace_back(surface + densities);
    surfaceSlopes.back() << value.hessian.col(surface).head(surface), value.hessian.col(surface).tail(densities);
  }
  return rest;
}

double
DeformableCost::EvaluateShape(const CoarseModel &     model,
                              const DeformableState & state,
                              const Execution &       execution) const
{
  const auto images = this->Project(model.MovePoints(state.coefficients), model.mesh, state.pose, execution);
  double     sum = 0.0;
  for (std::size_t v = 0; v < images.size(); ++v)
  {
    sum += m_Metrics[0][v]->Evaluate(images[v].data()) / static_cast<double>(images.size());
  }
  return sum;
}
} // namespace bone
