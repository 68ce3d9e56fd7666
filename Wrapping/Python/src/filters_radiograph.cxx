/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "radiograph_source.h"

#include "boneAttenuationImageFilter.h"
#include "boneDRRImageFilter.h"
#include "boneIntensityImageFilter.h"
#include "boneNoiseImageFilter.h"
#include "boneVoxelDRRImageFilter.h"

namespace bone::python
{
namespace
{
using DRRType = DRRImageFilter<Mesh, CTImage>;
using VoxelDRRType = VoxelDRRImageFilter<CTImage, CTImage>;

/** A filter from an image to an image. */
template <typename TFilter>
void
AddImageFilter(py::module_ & m, const char * name, const char * doc)
{
  auto filter = AddFilter<TFilter>(m, name, doc);
  AddImageInput(
    filter,
    "image",
    [](const TFilter & self) { return self.GetInput(); },
    [](TFilter & self, const CTImage * image) { self.SetInput(image); },
    "Image.");
  AddParameters(filter);
  AddOutput(
    filter, "output", [](TFilter & self) { return self.GetOutput(); }, "Image, float32.");
}

} // namespace

void
BindRadiographFilters(py::module_ & m)
{
  auto drr =
    AddFilter<DRRType>(m,
                       "DRRImageFilter",
                       "Digitally reconstructed radiograph of a tetrahedral density model: exact line integrals "
                       "from source to pixel.\n\nInputs: mesh, geometry.");
  AddInput<Mesh>(drr, "mesh", BONE_PYTHON_INPUT(DRRType, Input), "DensityMesh with a density.");
  AddParameters<DRRParameters>(
    drr,
    [](const DRRType & self) -> const DRRParameters & { return self.GetParameters(); },
    [](DRRType & self, const DRRParameters & parameters) { self.SetParameters(parameters); });
  AddRadiographSource(drr);

  auto voxel = AddFilter<VoxelDRRType>(m,
                                       "VoxelDRRImageFilter",
                                       "Digitally reconstructed radiograph of a CT, to compare with that of its "
                                       "model.\n\nInputs: image; geometry; mask, optional, a label map on its grid.");
  AddImageInput(voxel, "image", BONE_PYTHON_INPUT(VoxelDRRType, Input), "CT.");
  AddLabelInput(voxel, "mask", BONE_PYTHON_INPUT(VoxelDRRType, Mask), "Label map; optional.");
  AddParameters<VoxelDRRParameters>(
    voxel,
    [](const VoxelDRRType & self) -> const VoxelDRRParameters & { return self.GetParameters(); },
    [](VoxelDRRType & self, const VoxelDRRParameters & parameters) { self.SetParameters(parameters); });
  AddRadiographSource(voxel);

  AddImageFilter<AttenuationImageFilter<CTImage>>(
    m, "AttenuationImageFilter", "Converts a CT in HU to an image of attenuation per mm. Input: image.");
  AddImageFilter<IntensityImageFilter<CTImage>>(
    m, "IntensityImageFilter", "Intensity at the detector of line integrals of attenuation. Input: image.");
  AddImageFilter<NoiseImageFilter<CTImage>>(
    m, "NoiseImageFilter", "Quantum and electronic noise of an image of intensities. Input: image.");
}
} // namespace bone::python
