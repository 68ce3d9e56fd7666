/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFilterCases_h
#define boneFilterCases_h

#include "boneAtlasRegistrationFilter.h"
#include "boneAtlasVolumeRegistration.h"
#include "boneAttenuationImageFilter.h"
#include "boneBuildPipeline.h"
#include "boneCorticalThicknessFilter.h"
#include "boneDRRAdjointFilter.h"
#include "boneDRRDerivativeImageFilter.h"
#include "boneDeformableRadiographRegistration.h"
#include "boneDensityCalibrationFilter.h"
#include "boneDensityImageFilter.h"
#include "boneIntensityImageFilter.h"
#include "boneNoiseImageFilter.h"
#include "bonePhantomImageSource.h"
#include "boneRadiographPreprocessFilter.h"
#include "boneRigidRadiographRegistration.h"
#include "boneStatisticalModelEstimator.h"
#include "boneTetraSmoothingFilter.h"
#include "boneTetraSwapFilter.h"
#include "boneVoxelDRRImageFilter.h"

#include <string>

namespace bone
{
namespace test
{
/** What all cases take their inputs from: a coarse phantom and what the stages make of it. */
struct Specimen
{
  using Mesh = DensityMesh<double>;
  using Phantom = PhantomImageSource<CTImage>;

  Specimen();
  Phantom::Pointer          phantom;
  BuildPipeline             pipeline{ 2 };
  XRayGeometry::Pointer     geometry;
  Mesh::Pointer             other; ///< the same mesh, stretched
  StatisticalModel::Pointer atlas; ///< of the two
  CTImage::Pointer          ct;
  CTImage::Pointer          intensities; ///< of the radiograph's size, none negative
  LabelImage::Pointer       labels;

  static const Specimen &
  Get();
};

/** Calls visit(name, set, get) for each parameter of a filter's table. */
#define BONE_CASE_VALUE(type, member, Name, initial, range, unit, option, help)                                        \
  visit(                                                                                                               \
    #Name,                                                                                                             \
    [](Filter & f, const type & x) { f.Set##Name(x); },                                                                \
    [](const Filter & f) -> type { return f.Get##Name(); });
#define BONE_CASE_FLAG(member, Name, initial, option, help) BONE_CASE_VALUE(bool, member, Name, initial, , , , )
#define BONE_CASE_SETTERS(TABLE)                                                                                       \
  template <typename TVisitor>                                                                                         \
  static void VisitSetters([[maybe_unused]] TVisitor && visit)                                                         \
  {                                                                                                                    \
    TABLE(BONE_CASE_VALUE, BONE_CASE_FLAG)                                                                             \
  }

/** A case: the filter, a null or missing input's name in the error, whether its work takes long enough here to have at
 * least ten steps of progress, how its inputs are connected, and its setters. */
#define BONE_CASE(Name, TFilter, Input, Long, TABLE, ...)                                                              \
  struct Name                                                                                                          \
  {                                                                                                                    \
    using Filter = TFilter;                                                                                            \
    static constexpr const char * input = Input;                                                                       \
    static constexpr bool         isLong = Long;                                                                       \
    BONE_CASE_SETTERS(TABLE)                                                                                           \
    /** With `missing` the input that `input` names is null. */                                                        \
    static void                                                                                                        \
    Connect(Filter & f, bool missing)                                                                                  \
    {                                                                                                                  \
      [[maybe_unused]] const Specimen & s = Specimen::Get();                                                           \
      __VA_ARGS__                                                                                                      \
    }                                                                                                                  \
  }

#define BONE_NO_PARAMETERS(value, flag)

using Labels = LabelImage;
using Mesh = DensityMesh<double>;

BONE_CASE(PhantomCase, PhantomImageSource<CTImage>, "model", true, BONE_PHANTOM_IMAGE_PARAMETERS, {
  f.SetModel(missing ? nullptr : s.phantom->GetModel());
  f.SetSpacing(s.phantom->GetSpacing());
});
BONE_CASE(SnakeCase, SnakeContourFilter<CTImage>, "Image", true, BONE_SNAKE_CONTOUR_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.ct.GetPointer());
  f.SetLabelImage(s.labels);
});
BONE_CASE(SliceCase, ContourSliceFilter, "Contours", true, BONE_CONTOUR_SLICE_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetSnake()->GetOutput());
  f.SetMeanSpacing(20.0);
});
BONE_CASE(ResampleCase, ContourResampleFilter, "Contours", false, BONE_CONTOUR_RESAMPLE_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetSnake()->GetOutput());
});
BONE_CASE(AxisCase, MedialAxisFilter, "Contours", false, BONE_MEDIAL_AXIS_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetResample()->GetOutput());
});
BONE_CASE(TilingCase, ContourTilingMeshSource<>, "Contours", true, BONE_TILING_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetMedialAxis()->GetOutput());
  f.SetDensityImage(s.ct);
});
BONE_CASE(QualityCase, MeshQualityFilter<Mesh>, "Mesh", true, BONE_MESH_QUALITY_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetTiling()->GetOutput());
  f.SetContours(s.pipeline.GetSnake()->GetOutput());
  f.SetLabelImage(s.labels);
});
BONE_CASE(SmoothingCase, TetraSmoothingFilter<Mesh>, "Mesh", true, BONE_TETRA_SMOOTHING_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetTiling()->GetOutput());
});
BONE_CASE(SwapCase, TetraSwapFilter<Mesh>, "Mesh", false, BONE_TETRA_SWAP_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetTiling()->GetOutput());
});
BONE_CASE(FitCase, DensityFitFilter<CTImage>, "Mesh", true, BONE_DENSITY_FIT_PARAMETERS, {
  f.SetImage(s.ct);
  f.SetMesh(missing ? nullptr : s.pipeline.GetQuality()->GetOutput());
});
BONE_CASE(CalibrationCase, DensityCalibrationFilter<>, "Mesh", false, BONE_DENSITY_CALIBRATION_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetFit()->GetOutput());
  f.SetLine(3.0, 0.8, DensityQuantity::HydroxyapatiteMilligramPerCubicCentimetre);
});
BONE_CASE(ThicknessCase, CorticalThicknessFilter<CTImage>, "Mesh", true, BONE_CORTICAL_THICKNESS_PARAMETERS, {
  f.SetImage(s.ct);
  f.SetMesh(missing ? nullptr : s.pipeline.GetQuality()->GetOutput());
  f.SetPointSpread(3.0);
  f.SetCorticalDensity(1500.0);
});
BONE_CASE(DensityImageCase, DensityImageFilter<>, "Mesh", false, BONE_DENSITY_IMAGE_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetFit()->GetOutput());
  f.SetReferenceImage(s.ct);
});
BONE_CASE(CollapseCase, TetraCollapseFilter<Mesh>, "Mesh", true, BONE_TETRA_COLLAPSE_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetFit()->GetOutput());
  f.SetLevels({ s.pipeline.GetFit()->GetOutput()->GetNumberOfTetrahedra() / 2 });
});
BONE_CASE(LevelCase, HierarchyLevelFilter, "Hierarchy", false, BONE_NO_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetCollapse()->GetOutput());
  f.SetLevel(1);
});
BONE_CASE(DRRCase, DRRImageFilter<>, "Mesh", false, BONE_REGION_RANGE_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetFit()->GetOutput());
  f.SetGeometry(s.geometry);
});
BONE_CASE(DRROfViewCase, DRRImageFilter<>, "Geometry", false, BONE_RADIOGRAPH_PARAMETERS, {
  f.SetInput(s.pipeline.GetFit()->GetOutput());
  f.SetGeometry(missing ? nullptr : s.geometry.GetPointer());
});
BONE_CASE(DerivativeCase, DRRDerivativeImageFilter<>, "Mesh", false, BONE_REGION_RANGE_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetFit()->GetOutput());
  f.SetGeometry(s.geometry);
  RadiographModes modes;
  modes.pose = true;
  f.SetModes(modes);
});
BONE_CASE(AdjointCase, DRRAdjointFilter<>, "Image", false, BONE_DRR_ADJOINT_PARAMETERS, {
  f.SetInput(s.pipeline.GetFit()->GetOutput());
  f.SetGeometry(s.geometry);
  f.SetImage(missing ? nullptr : s.pipeline.GetRadiograph(0)->GetOutput());
});
BONE_CASE(VoxelDRRCase, VoxelDRRImageFilter<>, "Image", false, BONE_VOXEL_DRR_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.ct.GetPointer());
  f.SetMask(s.labels);
  f.SetGeometry(s.geometry);
});
BONE_CASE(AttenuationCase, AttenuationImageFilter<CTImage>, "Primary", false, BONE_RADIOGRAPH_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.ct.GetPointer());
  f.SetHUToAttenuation(HUToAttenuation::Bilinear);
});
BONE_CASE(IntensityCase, IntensityImageFilter<CTImage>, "Primary", false, BONE_INTENSITY_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.pipeline.GetRadiograph(0)->GetOutput());
});
BONE_CASE(NoiseCase, NoiseImageFilter<CTImage>, "Primary", false, BONE_NOISE_PARAMETERS, {
  f.SetInput(missing ? nullptr : s.intensities.GetPointer());
});
BONE_CASE(RegistrationCase, AtlasRegistrationFilter<>, "Standard", true, BONE_ATLAS_REGISTRATION_PARAMETERS, {
  f.SetStandard(missing ? nullptr : s.pipeline.GetQuality()->GetOutput());
  f.SetSubject(s.other);
});
BONE_CASE(PreprocessCase,
          RadiographPreprocessFilter<CTImage>,
          "Primary",
          false,
          BONE_RADIOGRAPH_PREPROCESS_PARAMETERS,
          {
            f.SetInput(missing ? nullptr : s.intensities.GetPointer());
            f.SetValues(RadiographValues::Intensity);
          });
BONE_CASE(RigidCase, RigidRadiographRegistration<Mesh>, "Model", true, BONE_RIGID_RADIOGRAPH_PARAMETERS, {
  f.SetModel(missing ? nullptr : s.pipeline.GetCollapse()->GetOutput());
  f.SetView(0, s.pipeline.GetRadiograph(0)->GetOutput(), s.geometry);
  f.SetSearches(1);
  f.SetPopulation(8);
  f.SetPixels(64);
  f.SetSearchPixels(32);
});
BONE_CASE(DeformableCase,
          DeformableRadiographRegistration<Mesh>,
          "Model",
          true,
          BONE_DEFORMABLE_RADIOGRAPH_PARAMETERS,
          {
            f.SetModel(missing ? nullptr : s.atlas.GetPointer());
            f.SetView(0, s.pipeline.GetRadiograph(0)->GetOutput(), s.geometry);
            f.SetTranslationDeviation(2.0);
            f.SetRotationDeviation(2.0);
            f.SetSmoothModes(3);
            f.SetSmoothDeviation(1.0);
            f.SetIntensities(false); // the radiographs are not of attenuation
            f.SetPopulation(8);
            f.SetPixels(64);
            f.SetSearchPixels(32);
            f.SetIterations(2);
          });
BONE_CASE(VolumeCase, AtlasVolumeRegistration<>, "Image", true, BONE_ATLAS_VOLUME_PARAMETERS, {
  f.SetImage(missing ? nullptr : s.ct.GetPointer());
  f.SetModel(s.atlas);
  f.SetHypotheses(20000);
  f.SetSmoothModes(0);
});
BONE_CASE(EstimatorCase, StatisticalModelEstimator<>, "TrainingSet", false, BONE_STATISTICAL_MODEL_PARAMETERS, {
  f.RemoveSubjects();
  if (!missing)
  {
    f.AddSubject("one", s.pipeline.GetFit()->GetOutput());
    f.AddSubject("two", s.other);
  }
});
} // namespace test
} // namespace bone

#endif
