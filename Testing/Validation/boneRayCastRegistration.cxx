/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen

#include "boneRayCastRegistration.h"

#include "boneExecution.h"

#include <itkIdentityTransform.h>
#include <itkPowellOptimizer.h>
#include <itkRayCastInterpolateImageFunction.h>

#include <cmath>

namespace bone
{
namespace
{
const double Degree = std::acos(-1.0) / 180.0;

/** Parameters: turns about the centre's axes, degrees, and translations along them, mm. */
class RayCastCost : public itk::SingleValuedCostFunction
{
public:
  using Self = RayCastCost;
  using Pointer = itk::SmartPointer<Self>;
  itkNewMacro(Self);

  const CTImage *             ct{ nullptr };
  std::vector<RadiographView> views;
  RigidPose                   start;
  double                      threshold{ 0.0 };

  RigidPose
  PoseAt(const ParametersType & parameters) const
  {
    Eigen::Matrix<double, 6, 1> step;
    step << parameters[3], parameters[4], parameters[5], Degree * parameters[0], Degree * parameters[1],
      Degree * parameters[2];
    return start.Moved(step);
  }

  unsigned int
  GetNumberOfParameters() const override
  {
    return 6;
  }
  void
  GetDerivative(const ParametersType &, DerivativeType &) const override
  {
    itkExceptionMacro("Powell's method asks for values alone.");
  }

  /** Mean normalized correlation of the views. */
  MeasureType
  GetValue(const ParametersType & parameters) const override
  {
    const RigidPose pose = this->PoseAt(parameters);
    double          sum = 0.0;
    for (const RadiographView & view : views)
    {
      sum += Correlation(this->Project(pose.ToModelSpace(view.view)), view.values) / static_cast<double>(views.size());
    }
    return sum;
  }

private:
  /** Turned about the image's origin to its own axes: the interpolator ignores its direction. */
  itk::Point<double, 3>
  ToVolume(const Vector3 & x) const
  {
    const auto            origin = ct->GetOrigin();
    const auto            direction = ct->GetDirection();
    itk::Point<double, 3> local = origin;
    for (unsigned int k = 0; k < 3; ++k)
    {
      for (unsigned int i = 0; i < 3; ++i)
      {
        local[k] += direction[i][k] * (x[i] - origin[i]);
      }
    }
    return local;
  }

  std::vector<float>
  Project(const XRayGeometry::View & view) const
  {
    using Interpolator = itk::RayCastInterpolateImageFunction<CTImage, double>;
    auto interpolator = Interpolator::New();
    interpolator->SetInputImage(ct);
    interpolator->SetTransform(itk::IdentityTransform<double, 3>::New());
    interpolator->SetFocalPoint(this->ToVolume(view.source));
    interpolator->SetThreshold(threshold);
    std::vector<float> image(static_cast<std::size_t>(view.size[0]) * static_cast<std::size_t>(view.size[1]));
    Execution().Silent().For(static_cast<std::size_t>(view.size[1]), [&](std::size_t r) {
      for (int c = 0; c < view.size[0]; ++c)
      {
        const Vector3 x = view.detectorOrigin + c * view.spacing[0] * view.detectorU +
                          static_cast<double>(r) * view.spacing[1] * view.detectorV;
        image[r * static_cast<std::size_t>(view.size[0]) + static_cast<std::size_t>(c)] =
          static_cast<float>(interpolator->Evaluate(this->ToVolume(x)));
      }
    });
    return image;
  }

  static double
  Correlation(const std::vector<float> & a, const std::vector<float> & b)
  {
    const Eigen::Map<const Eigen::ArrayXf> x(a.data(), static_cast<Eigen::Index>(a.size()));
    const Eigen::Map<const Eigen::ArrayXf> y(b.data(), static_cast<Eigen::Index>(b.size()));
    const Eigen::ArrayXd                   u = x.cast<double>() - x.cast<double>().mean();
    const Eigen::ArrayXd                   v = y.cast<double>() - y.cast<double>().mean();
    return (u * v).sum() / std::sqrt(u.square().sum() * v.square().sum() + 1e-30);
  }
};
} // namespace

RigidPose
RegisterByRayCasting(const CTImage *                     ct,
                     const std::vector<RadiographView> & views,
                     const RigidPose &                   start,
                     int                                 pixels,
                     double                              threshold)
{
  auto cost = RayCastCost::New();
  cost->ct = ct;
  cost->start = start;
  cost->threshold = threshold;
  for (const RadiographView & view : views)
  {
    cost->views.push_back(ReduceView(view, ReductionTo(view.view, pixels)));
  }
  auto optimizer = itk::PowellOptimizer::New();
  optimizer->SetCostFunction(cost);
  optimizer->SetMaximize(true);
  optimizer->SetMaximumIteration(10);
  optimizer->SetMaximumLineIteration(4);
  optimizer->SetStepLength(4.0);
  optimizer->SetStepTolerance(0.02);
  optimizer->SetValueTolerance(0.001);
  RayCastCost::ParametersType origin(6);
  origin.Fill(0.0);
  optimizer->SetInitialPosition(origin);
  optimizer->StartOptimization();
  return cost->PoseAt(optimizer->GetCurrentPosition());
}
} // namespace bone
