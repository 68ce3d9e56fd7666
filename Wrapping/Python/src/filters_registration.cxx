/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "reports.h"

#include "boneAtlasVolumeRegistration.h"
#include "boneDeformableRadiographRegistration.h"
#include "boneRadiographPreprocessFilter.h"
#include "boneRigidRadiographRegistration.h"

#include <itkEuler3DTransform.h>

namespace bone::python
{
namespace
{
using RigidType = RigidRadiographRegistration<Mesh, CTImage>;
using DeformableType = DeformableRadiographRegistration<Mesh, CTImage>;
using VolumeType = AtlasVolumeRegistration<CTImage, Mesh>;
using PreprocessType = RadiographPreprocessFilter<CTImage, CTImage>;

/** 4 x 4, from the model's space to the geometry's. */
Eigen::Matrix4d
ToMatrix(const RigidPose & pose)
{
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = pose.rotation;
  matrix.topRightCorner<3, 1>() = pose.Apply(Vector3::Zero());
  return matrix;
}

RigidPose
ToPose(const Eigen::MatrixXd & matrix)
{
  const bool            square = matrix.rows() == 4 && matrix.cols() == 4;
  RigidPose             pose;
  const Eigen::Matrix3d rotation = square ? Eigen::Matrix3d(matrix.topLeftCorner<3, 3>()) : Eigen::Matrix3d::Zero();
  if (!((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6) ||
      !(rotation.determinant() > 0))
  {
    throw UsageFailure("a transform must be 4 x 4 numbers, a rotation and a translation (mm)");
  }
  pose.rotation = rotation;
  pose.translation = matrix.topRightCorner<3, 1>();
  return pose;
}

py::dict
DescribeResult(const RigidRegistrationResult & result)
{
  py::dict dict;
  dict["transform"] = ToMatrix(result.pose);
  dict["centre"] = FromVector(result.pose.centre);
  dict["quality"] = ParameterText(result.quality);
  dict["cost"] = result.cost;
  dict["costs"] = result.costs;
  dict["covariance"] = result.covariance;
  dict["converged"] = result.converged;
  dict["distinctness"] = result.distinctness;
  return dict;
}

py::list
DescribeRegions(const std::vector<RegionEstimate> & regions)
{
  py::list list;
  for (const RegionEstimate & region : regions)
  {
    py::dict entry;
    entry["region"] = region.region;
    entry["volume"] = region.volume;
    entry["volume_deviation"] = region.volumeDeviation;
    entry["density"] = region.density;
    entry["density_deviation"] = region.densityDeviation;
    entry["mass"] = region.mass;
    entry["mass_deviation"] = region.massDeviation;
    list.append(entry);
  }
  return list;
}

py::dict
DescribeDeformable(const DeformableRegistrationResult & result)
{
  py::dict dict;
  dict["transform"] = ToMatrix(result.pose);
  dict["quality"] = ParameterText(result.quality);
  dict["coefficients"] = result.coefficients;
  dict["shape_modes"] = result.shapeModes;
  dict["smooth_modes"] = result.smoothModes;
  dict["density_modes"] = result.densityModes;
  dict["covariance"] = result.covariance;
  dict["point_deviations"] = FromPoints(result.pointDeviations);
  dict["regions"] = DescribeRegions(result.regions);
  dict["cost"] = result.cost;
  dict["costs"] = result.costs;
  dict["converged"] = result.converged;
  dict["distinctness"] = result.distinctness;
  return dict;
}

py::dict
DescribeVolume(const VolumeRegistrationResult & result)
{
  py::dict dict;
  dict["transform"] = ToMatrix(result.pose);
  dict["mirrored"] = result.mirrored;
  dict["quality"] = ParameterText(result.quality);
  dict["coefficients"] = result.coefficients;
  dict["shape_modes"] = result.shapeModes;
  dict["smooth_modes"] = result.smoothModes;
  dict["density_scores"] = result.densityScores;
  dict["covariance"] = result.covariance;
  dict["point_deviations"] = FromPoints(result.pointDeviations);
  dict["regions"] = DescribeRegions(result.regions);
  dict["visible"] = result.support.visible;
  dict["supported"] = result.support.supported;
  dict["residual"] = result.support.residual;
  return dict;
}

/** Views and initial transform of a registration to X-rays. */
template <typename TFilter>
void
AddViews(FilterClass<TFilter> & filter)
{
  filter.def(
    "set_view",
    [](TFilter &          self,
       unsigned int       view,
       const py::object & radiograph,
       XRayGeometry &     geometry,
       const py::object & weights) {
      const auto image = ToCT(ToImage(radiograph));
      const auto weight = weights.is_none() ? CTImage::Pointer() : ToCT(ToImage(weights));
      HoldSource(self, "radiograph " + std::to_string(view), image);
      HoldSource(self, "weights " + std::to_string(view), weight);
      self.SetView(view, image, &geometry, weight);
    },
    py::arg("view"),
    py::arg("radiograph"),
    py::arg("geometry"),
    py::arg("weights") = py::none(),
    "View 0, 1, ...: an X-ray of line integrals in any unit (1 x rows x columns), its XRayGeometry, and weights from 0 "
    "to 1 where some pixels are not to count. Views before it must be set too.");
  filter.def(
    "set_initial_transform",
    [](TFilter & self, const Eigen::MatrixXd & matrix) { self.SetInitialTransform(ToPose(matrix).ToTransform()); },
    py::arg("matrix"),
    "Where the model is about: 4 x 4, from its space to the geometry's, mm.");
}

void
BindRigid(py::module_ & m)
{
  auto rigid = AddFilter<RigidType>(m,
                                    "RigidRadiographRegistration",
                                    "Finds the poses of one or more density models in one or more X-rays.\n\n"
                                    "Inputs: model; views by set_view(). result says pose and how far to trust it.");
  AddInput<DensityHierarchy<>>(
    rigid,
    "model",
    [](const RigidType & self) { return self.GetModel(); },
    [](RigidType & self, const DensityHierarchy<> * model) { self.SetModel(model); },
    "DensityHierarchy, all of whose levels have a density.");
  AddViews(rigid);
  AddParameters(rigid);
  rigid.def(
    "set_body",
    [](RigidType & self, unsigned int body, DensityHierarchy<> & model) {
      HoldSource(self, "model " + std::to_string(body), &model);
      self.SetModel(body, &model);
    },
    py::arg("body"),
    py::arg("model"),
    "The model of body 0, 1, ..., each free to move.");
  rigid.def(
    "result",
    [](const RigidType & self, unsigned int body) { return DescribeResult(self.GetResult(body)); },
    py::arg("body") = 0,
    "After an update: a dict of transform (4 x 4, model to geometry), centre, quality (ok, suspect, failed), cost, "
    "costs, "
    "covariance (6 x 6; mm and radians about the centre), converged and distinctness.");
}

void
BindDeformable(py::module_ & m)
{
  auto filter = AddFilter<DeformableType>(m,
                                          "DeformableRadiographRegistration",
                                          "Finds pose, shape and density of a bone in X-rays, by an atlas.\n\n"
                                          "Inputs: model; views by set_view(). Output: DensityMesh.");
  AddInput<StatisticalModel>(filter, "model", BONE_PYTHON_INPUT(DeformableType, Model), "StatisticalModel.");
  AddViews(filter);
  AddParameters(filter);
  AddOutput(
    filter, "output", [](DeformableType & self) { return self.GetOutput(); }, "DensityMesh in the geometry's space.");
  filter.def(
    "result",
    [](const DeformableType & self) { return DescribeDeformable(self.GetResult()); },
    "After an update: a dict of transform (4 x 4, atlas to geometry), quality, coefficients (standard deviations), "
    "covariance, point_deviations (n x 3, mm), regions, cost and more.");
}

void
BindVolume(py::module_ & m)
{
  auto filter =
    AddFilter<VolumeType>(m,
                          "AtlasVolumeRegistration",
                          "Finds an atlas' bone in a CT without a label map.\n\n"
                          "Inputs: image (CT in HU), model. Outputs: output (DensityMesh), labels (Image).");
  AddImageInput(filter, "image", BONE_PYTHON_INPUT(VolumeType, Image), "CT in HU.");
  AddInput<StatisticalModel>(filter, "model", BONE_PYTHON_INPUT(VolumeType, Model), "StatisticalModel.");
  AddParameters(filter);
  AddOutput(
    filter, "output", [](VolumeType & self) { return self.GetOutput(); }, "DensityMesh in the CT's space.");
  AddOutput(
    filter, "labels", [](VolumeType & self) { return self.GetLabelImage(); }, "Image, int16: regions.");
  filter.def(
    "result",
    [](const VolumeType & self) { return DescribeVolume(self.GetResult()); },
    "After an update: a dict of transform, mirrored, quality, coefficients, regions, supported and more.");
}

void
BindPreprocess(py::module_ & m)
{
  auto filter = AddFilter<PreprocessType>(m,
                                          "RadiographPreprocessFilter",
                                          "Line integrals and weights of what a detector gives.\n\n"
                                          "Inputs: image; mask, optional. Outputs: output, weights.");
  AddImageInput(
    filter,
    "image",
    [](const PreprocessType & self) { return self.GetInput(); },
    [](PreprocessType & self, const CTImage * image) { self.SetInput(image); },
    "1 x rows x columns.");
  AddLabelInput(filter, "mask", BONE_PYTHON_INPUT(PreprocessType, Mask), "Image, int16; 0: not used; optional.");
  AddParameters(filter);
  AddOutput(
    filter, "output", [](PreprocessType & self) { return self.GetOutput(); }, "Image: line integrals.");
  AddOutput(
    filter, "weights", [](PreprocessType & self) { return self.GetWeights(); }, "Image: 0 to 1.");
  AddReport(
    filter,
    "After an update: a dict of open_beam, air_share, collimator (edges by normal and offset, pixels), dead_pixels, "
    "saturated, used_share, scatter_to_primary and more.");
}
} // namespace

void
BindRegistrationFilters(py::module_ & m)
{
  BindRigid(m);
  BindDeformable(m);
  BindVolume(m);
  BindPreprocess(m);
}
} // namespace bone::python
