/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "radiograph_source.h"

#include "boneDRRAdjointFilter.h"
#include "boneDRRDerivativeImageFilter.h"

namespace bone::python
{
namespace
{
using DerivativeType = DRRDerivativeImageFilter<Mesh, CTImage>;
using AdjointType = DRRAdjointFilter<Mesh, CTImage>;

void
BindDerivativeFilter(py::module_ & m)
{
  auto filter = AddFilter<DerivativeType>(
    m,
    "DRRDerivativeImageFilter",
    "The radiograph of a density model with its derivatives by pose, shape and density, in one run.\n\n"
    "Inputs: mesh, geometry. set_modes() says which derivatives; derivative(m) is the m-th, in the radiograph's unit "
    "per mm, per radian or per unit of the mode.");
  AddInput<Mesh>(
    filter,
    "mesh",
    [](const DerivativeType & self) { return self.GetInput(); },
    [](DerivativeType & self, const Mesh * mesh) { self.SetInput(mesh); },
    "DensityMesh with a density.");
  AddParameters<DRRParameters>(
    filter,
    [](const DerivativeType & self) -> const DRRParameters & { return self.GetParameters(); },
    [](DerivativeType & self, const DRRParameters & parameters) { self.SetParameters(parameters); });
  AddRadiographSource(filter);
  filter.def(
    "set_modes",
    [](DerivativeType &                   self,
       bool                               pose,
       const py::object &                 centre,
       const std::vector<Array<double>> & shape,
       const std::vector<Array<double>> & density) {
      RadiographModes modes;
      modes.pose = pose;
      modes.poseCentre = centre.is_none() ? Vector3(Vector3::Zero()) : ToVector(centre, "pose_centre");
      for (const auto & mode : shape)
      {
        modes.shape.push_back(ToPoints(mode, "a shape mode"));
      }
      for (const auto & mode : density)
      {
        modes.density.emplace_back(mode.data(), mode.data() + mode.size());
      }
      self.SetModes(std::move(modes));
    },
    py::kw_only(),
    py::arg("pose") = false,
    py::arg("pose_centre") = py::none(),
    py::arg("shape") = std::vector<Array<double>>(),
    py::arg("density") = std::vector<Array<double>>(),
    "pose: translation along x, y, z (per mm), rotation about axes through pose_centre (per radian). shape: "
    "displacements of the points, n x 3 (mm), a mode each. density: changes of the coefficients, m x k, a mode each.");
  filter.def(
    "derivative",
    [](const py::object & self, unsigned int mode) {
      auto & derived = self.cast<DerivativeType &>();
      if (mode >= derived.GetModes().Count())
      {
        throw UsageFailure("there is no mode " + std::to_string(mode) + ": set_modes() gave " +
                           std::to_string(derived.GetModes().Count()));
      }
      return OutputOf(self, derived.GetDerivative(mode));
    },
    py::arg("mode"),
    "Image of the derivative by a mode; in order: six of the pose, those of shape, those of density.");
}

void
BindAdjointFilter(py::module_ & m)
{
  auto filter = AddFilter<AdjointType>(
    m,
    "DRRAdjointFilter",
    "From a radiograph back to a density model: the transpose of DRRImageFilter.\n\n"
    "Inputs: mesh; image, columns x rows x 1: derivatives of a function by the radiograph's pixels; geometry. Outputs: "
    "output, the mesh with the function's derivatives by its coefficients in their place; point_gradient.");
  AddInput<Mesh>(filter, "mesh", BONE_PYTHON_INPUT(AdjointType, Input), "DensityMesh with a density.");
  AddImageInput(filter, "image", BONE_PYTHON_INPUT(AdjointType, Image), "1 x rows x columns.");
  AddInput<XRayGeometry>(filter, "geometry", BONE_PYTHON_INPUT(AdjointType, Geometry), "XRayGeometry.");
  AddParameters(filter);
  AddOutput(
    filter, "output", [](AdjointType & self) { return self.GetOutput(); }, "DensityMesh.");
  filter.def_property_readonly(
    "point_gradient",
    [](const AdjointType & self) { return FromPoints(self.GetPointGradient()); },
    "n x 3, per mm, after an update.");
}
} // namespace

void
BindRadiographOperators(py::module_ & m)
{
  BindDerivativeFilter(m);
  BindAdjointFilter(m);
}
} // namespace bone::python
