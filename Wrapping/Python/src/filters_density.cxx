/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "reports.h"

#include "boneCorticalThicknessFilter.h"
#include "boneDensityCalibrationFilter.h"
#include "boneDensityFitFilter.h"
#include "boneDensityImageFilter.h"
#include "boneMakePhantom.h"
#include "bonePhantomImageSource.h"

namespace bone::python
{
namespace
{
using ThicknessType = CorticalThicknessFilter<CTImage, Mesh>;
using FitType = DensityFitFilter<CTImage, Mesh>;
using CalibrationType = DensityCalibrationFilter<CTImage, Mesh>;
using RasterType = DensityImageFilter<Mesh, CTImage>;
using PhantomType = PhantomImageSource<CTImage>;

void
BindFit(py::module_ & m)
{
  auto fit = AddFilter<FitType>(
    m,
    "DensityFitFilter",
    "Fits a Bernstein polynomial to an image in every tetrahedron of a mesh.\n\n"
    "Inputs: mesh; image (CT); weights, optional, an image of 0 or more: how much values count. Output: DensityMesh.");
  AddInput<Mesh>(fit, "mesh", BONE_PYTHON_INPUT(FitType, Input), "DensityMesh; a density that it holds is replaced.");
  AddImageInput(fit, "image", BONE_PYTHON_INPUT(FitType, Image), "CT.");
  AddImageInput(fit, "weights", BONE_PYTHON_INPUT(FitType, Weights), "How much values count; optional.");
  AddParameters(fit);
  AddOutput(
    fit, "output", [](FitType & self) { return self.GetOutput(); }, "DensityMesh.");
  AddReport(
    fit,
    "After an update: a dict of samples, outside, finite, voxels, and the numbers of sparse, unsupported and limited "
    "tetrahedra; overshoot_median, overshoot_90 and overshoot_maximum in ranges of a tetrahedron's data.");
  fit.def_property_readonly("outside_fraction",
                            &FitType::GetOutsideFraction,
                            "Share of the samples that lay beyond the image, after an update.");
  fit.def_property_readonly(
    "doubts",
    &FitType::GetDoubts,
    "After an update: a line for each reason to think that the mesh and the image do not belong together.");
}

void
BindCalibration(py::module_ & m)
{
  auto calibration =
    AddFilter<CalibrationType>(m,
                               "DensityCalibrationFilter",
                               "Turns a density model in HU into one in mineral, ash or apparent density.\n\n"
                               "Input: mesh. First comes a line, density = intercept + slope HU, then laws by name.");
  AddInput<Mesh>(calibration, "mesh", BONE_PYTHON_INPUT(CalibrationType, Input), "DensityMesh with a density.");
  AddImageInput(calibration, "image", BONE_PYTHON_INPUT(CalibrationType, Image), "CT; optional.");
  AddLabelInput(calibration, "labels", BONE_PYTHON_INPUT(CalibrationType, Labels), "Label map; optional.");
  AddParameters(calibration);
  calibration.def_property("laws",
                           &CalibrationType::GetLaws,
                           &CalibrationType::SetLaws,
                           "Names of published laws, applied in this order after the line.");
  AddOutput(
    calibration, "output", [](CalibrationType & self) { return self.GetOutput(); }, "DensityMesh.");
}

void
BindRaster(py::module_ & m)
{
  auto raster =
    AddFilter<RasterType>(m,
                          "DensityImageFilter",
                          "Samples a density model at the voxel centres of an image.\n\n"
                          "Inputs: mesh; reference, the image whose grid is taken. Output: Image, float32.");
  AddInput<Mesh>(raster, "mesh", BONE_PYTHON_INPUT(RasterType, Input), "DensityMesh with a density.");
  raster.def_property(
    "reference",
    [](RasterType & self) { return itk::SmartPointer<ImageBase>(const_cast<ImageBase *>(self.GetReferenceImage())); },
    [](RasterType & self, const py::object & object) {
      const auto image = ToImage(object);
      HoldSource(self, "reference", image);
      self.SetReferenceImage(image);
    },
    "Image whose grid is taken.");
  AddParameters(raster);
  // Any number, as in C++; NaN lies in no range.
  const std::string help = raster.attr("outside_value").attr("__doc__").cast<std::string>();
  raster.def_property(
    "outside_value",
    &RasterType::GetOutsideValue,
    [](RasterType & self, const py::object & value) {
      self.SetOutsideValue(ToReal(value, { "outsideValue", "OutsideValue", ParameterRange::Any(), "", "", "" }));
    },
    (help + " It may be NaN.").c_str());
  AddOutput(
    raster, "output", [](RasterType & self) { return self.GetOutput(); }, "Image, float32.");
}

void
BindPhantom(py::module_ & m)
{
  auto phantom =
    AddFilter<PhantomType>(m,
                           "PhantomImageSource",
                           "CT and label map of an analytic phantom, whose density is known exactly.\n\n"
                           "Set a phantom (set_phantom) and spacing (mm). Outputs: output, CT in HU; labels, regions.");
  phantom.def(
    "set_phantom",
    [](PhantomType & self, const std::string & name, std::uint64_t seed) { self.SetModel(MakePhantom(name, seed)); },
    py::arg("name"),
    py::arg("seed") = 0,
    "femur or hemipelvis; seed 0 is the mean subject.");
  phantom.def_property(
    "spacing",
    [](const PhantomType & self) { return FromVector(Vector3(self.GetSpacing().GetDataPointer())); },
    [](PhantomType & self, const py::object & object) { self.SetSpacing(ToVector(object, "spacing").data()); },
    "(x, y, z), mm.");
  AddParameters(phantom);
  AddOutput(
    phantom, "output", [](PhantomType & self) { return self.GetOutput(); }, "Image, float32: CT in HU.");
  AddOutput(
    phantom, "labels", [](PhantomType & self) { return self.GetLabelOutput(); }, "Image, int16: regions.");
}

py::dict
DescribeMap(const CorticalThicknessMap & map)
{
  const std::vector<std::array<IdType, 3>> & triangles = map.surface.triangles;
  std::vector<int>                           status;
  for (const CorticalStatus of : map.status)
  {
    status.push_back(static_cast<int>(of));
  }
  return py::dict(py::arg("points") = FromPoints(map.surface.points),
                  py::arg("triangles") =
                    py::array_t<IdType>({ static_cast<py::ssize_t>(triangles.size()), py::ssize_t{ 3 } },
                                        triangles.empty() ? nullptr : triangles.front().data()),
                  py::arg("point_ids") = Copy(map.pointId),
                  py::arg("thickness") = Copy(map.thickness),
                  py::arg("fitted") = Copy(map.fitted),
                  py::arg("density") = Copy(map.density),
                  py::arg("status") = Copy(status),
                  py::arg("cortical_density") = map.corticalDensity);
}

void
BindThickness(py::module_ & m)
{
  auto thickness = AddFilter<ThicknessType>(
    m,
    "CorticalThicknessFilter",
    "Cortical thickness at the points of a mesh's exterior surface, measured in the CT along the inward normal.\n\n"
    "Inputs: mesh, of any density or none; image (CT in HU). After an update: map.");
  AddInput<Mesh>(thickness, "mesh", BONE_PYTHON_INPUT(ThicknessType, Mesh), "DensityMesh.");
  AddImageInput(thickness, "image", BONE_PYTHON_INPUT(ThicknessType, Image), "CT in HU.");
  AddParameters(thickness);
  thickness.def_property_readonly(
    "map",
    [](const ThicknessType & self) { return DescribeMap(self.GetMap()); },
    "After an update: a dict of points (n x 3, mm), triangles (t x 3), point_ids (in the mesh), thickness (mm) and "
    "fitted "
    "(mm, before outliers were replaced and it was smoothed), density (HU, of the cortex), status (0 none, 1 found, 2 "
    "solid, 3 outside; others than found are NaN), and cortical_density (HU, where the cortex is thin).");
  AddMember(thickness, "map", "dict[str, Any]", true);
}
} // namespace

void
BindDensityFilters(py::module_ & m)
{
  BindThickness(m);
  BindFit(m);
  BindCalibration(m);
  BindRaster(m);
  BindPhantom(m);
}
} // namespace bone::python
