/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFuzzFormats.h"

#include "boneBuildParameters.h"
#include "boneContourIO.h"
#include "boneContourTilingMeshSource.h"
#include "boneCorrespondenceIO.h"
#include "boneDRRImageFilter.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneLabelChoice.h"
#include "boneLandmarkIO.h"
#include "boneMeshIO.h"
#include "boneMeshValidator.h"
#include "boneModelIO.h"
#include "bonePopulation.h"
#include "boneSurfaceLabels.h"
#include "boneTetraCollapseFilter.h"
#include "boneTetraSmoothingFilter.h"
#include "boneTransformIO.h"
#include "boneXRayIO.h"

#include <Eigen/Eigenvalues> // stands for the older one of ITK's own that its transforms bring

#include <itkEuler3DTransform.h>

#include <algorithm>
#include <filesystem>

namespace bone
{
namespace
{
namespace fs = std::filesystem;
using Mesh = DensityMesh<double>;

/** Refines a pose, with few pixels. */
const std::string Register = "register rigid --search 0 0 --pixels 32 --no-collimator ";

/** Finds the bone of an atlas of three subjects, with few trials. */
const std::string FewHypotheses = " --hypotheses 2000 --smooth-modes 0 ";

std::string
Beside(const std::string & path, const char * name)
{
  return (fs::path(path).parent_path() / name).string();
}

XRayGeometry::Pointer
SmallView(const MeshArrays & mesh)
{
  XRayGeometry::View view;
  view.source = mesh.points.front() - 500.0 * Vector3::UnitY();
  view.detectorOrigin = mesh.points.front() + Vector3(-20.0, 100.0, -20.0);
  view.size = { { 12, 12 } };
  view.spacing = { 4.0, 4.0 };
  auto geometry = XRayGeometry::New();
  geometry->SetView(view);
  return geometry;
}

void
UseMesh(const std::string & path)
{
  ValidateMesh(ReadMeshArrays(path));
  const Mesh::Pointer mesh = ReadDensityMesh(path);
  auto                smoothing = TetraSmoothingFilter<Mesh>::New();
  smoothing->SetInput(mesh);
  smoothing->SetIterations(1);
  smoothing->Update();
  auto collapse = TetraCollapseFilter<Mesh>::New();
  collapse->SetInput(mesh);
  collapse->SetLevels({ std::max<IdType>(1, mesh->GetNumberOfTetrahedra() / 2) });
  collapse->Update();
  auto radiograph = DRRImageFilter<Mesh, CTImage>::New();
  radiograph->SetInput(mesh);
  radiograph->SetGeometry(SmallView(mesh->GetArrays()));
  radiograph->Update();
}

void
UseContours(const std::string & path)
{
  auto tiling = ContourTilingMeshSource<Mesh>::New();
  tiling->SetInput(ReadContours(path));
  tiling->Update();
}

void
UseSurface(const std::string & path)
{
  auto grid = LabelImage::New();
  grid->SetRegions(LabelImage::SizeType{ { 20, 20, 20 } });
  grid->SetSpacing(itk::Vector<double, 3>(2.0));
  LabelsOfSurface(ReadTriangleSurface(path), grid);
}

void
UseGeometry(const std::string & path)
{
  for (const auto & view : ReadGeometry(path))
  {
    const auto & size = view->GetView().size;
    if (static_cast<double>(size[0]) * size[1] <= 1e5)
    {
      const Mesh::Pointer mesh = ReadDensityMesh(Beside(path, "model_L2.vtu"));
      auto                radiograph = DRRImageFilter<Mesh, CTImage>::New();
      radiograph->SetInput(mesh);
      radiograph->SetGeometry(view);
      radiograph->Update();
    }
  }
}

void
UseAtlas(const std::string & path)
{
  const auto   model = ReadStatisticalModel(path);
  const auto & content = model->GetContent();
  model->Synthesize(Eigen::VectorXd::Ones(content.shape.GetNumberOfModes()),
                    Eigen::VectorXd::Ones(content.density.GetNumberOfModes()));
}

void
UseLabels(const std::string & path)
{
  const LabelFile file = ReadLabelFile(path);
  CountLabels(OpenLabelFile(path));
  const auto labels = CountLabels(file);
  if (!labels.empty())
  {
    ChooseBones(file, { labels[0].name.empty() ? std::to_string(labels[0].value) : labels[0].name });
  }
}

void
UseParameters(const std::string & path)
{
  BuildParameters parameters;
  BuildFiles      files;
  ReadBuildParameters(path, parameters, files);
}

void
UseImage(const std::string & path)
{
  const auto          source = OpenCT(path);
  CTImage *           ct = source->GetOutput();
  CTImage::RegionType last = ct->GetLargestPossibleRegion();
  last.SetIndex(2, last.GetUpperIndex()[2]);
  last.SetSize(2, 1);
  ct->SetRequestedRegion(last);
  ct->Update();
  ReadCT(path);
}

void
UseXRay(const std::string & path)
{
  ReadXRay(path);
}

void
UseTransform(const std::string & path)
{
  ReadRigidTransform(path);
}

void
UseLandmarks(const std::string & path)
{
  ReadLandmarks(path);
}

void
UseImageLandmarks(const std::string & path)
{
  ReadImageLandmarks(path, ReadGeometry(Beside(path, "view.json")).front()->GetView());
}

void
UseHierarchy(const std::string & path)
{
  ReadHierarchy(path);
}

void
UseCorrespondence(const std::string & path)
{
  ReadCorrespondence(path);
}

void
UseLabelTable(const std::string & path)
{
  ReadLabelTable(path);
}

void
UseSubjects(const std::string & path)
{
  VerifySubjects(ReadSubjectList(path));
}

template <typename TImage>
bool
SameBuffer(const TImage & a, const TImage & b)
{
  const auto region = a.GetBufferedRegion();
  return region == b.GetBufferedRegion() &&
         std::equal(a.GetBufferPointer(), a.GetBufferPointer() + region.GetNumberOfPixels(), b.GetBufferPointer());
}

bool
SameImage(const std::string & a, const std::string & b)
{
  return SameBuffer(*ReadCT(a), *ReadCT(b));
}

bool
SameXRay(const std::string & a, const std::string & b)
{
  return SameBuffer(*ReadXRay(a).image, *ReadXRay(b).image);
}

bool
SameMesh(const std::string & a, const std::string & b)
{
  const MeshArrays one = ReadMeshArrays(a);
  const MeshArrays other = ReadMeshArrays(b);
  return one.points == other.points && one.tetrahedra == other.tetrahedra && one.region == other.region &&
         one.layer == other.layer && one.slice == other.slice && one.degree == other.degree &&
         one.coefficients == other.coefficients;
}

bool
SameContours(const std::string & a, const std::string & b)
{
  const auto one = ReadContours(a);
  const auto other = ReadContours(b);
  return std::equal(one->GetSlices().begin(),
                    one->GetSlices().end(),
                    other->GetSlices().begin(),
                    other->GetSlices().end(),
                    [](const ContourSlice & p, const ContourSlice & q) {
                      return std::equal(p.contours.begin(),
                                        p.contours.end(),
                                        q.contours.begin(),
                                        q.contours.end(),
                                        [](const Contour & c, const Contour & d) {
                                          return c.points == d.points && c.layer == d.layer && c.region == d.region &&
                                                 c.axis == d.axis;
                                        });
                    });
}

bool
SameModel(const std::string & a, const std::string & b)
{
  const auto   one = ReadStatisticalModel(a);
  const auto   other = ReadStatisticalModel(b);
  const auto & p = one->GetContent();
  const auto & q = other->GetContent();
  return p.mean.tetrahedra == q.mean.tetrahedra && p.shape.mean == q.shape.mean && p.shape.modes == q.shape.modes &&
         p.density.mean == q.density.mean && p.density.modes == q.density.modes;
}

/** What a reader of another file does, which lies beside the damaged one and names it. */
std::function<void(const std::string &)>
With(const char * name, void (*use)(const std::string &))
{
  return [name, use](const std::string & path) { use(Beside(path, name)); };
}

bool
SameHeaderedImage(const std::string & a, const std::string & b)
{
  return SameImage(Beside(a, "ct.mhd"), Beside(b, "ct.mhd"));
}

bool
SamePair(const std::string & a, const std::string & b)
{
  return SameImage(Beside(a, "pair.hdr"), Beside(b, "pair.hdr"));
}

void
UseStructures(const std::string & path)
{
  ReadContours(path, { "femur" });
}

void
UseFolder(const std::string & path)
{
  ReadCT(fs::path(path).parent_path().string());
}

bool
SameFolder(const std::string & a, const std::string & b)
{
  return SameImage(fs::path(a).parent_path().string(), fs::path(b).parent_path().string());
}

std::vector<FuzzFormat>
ImageFormats()
{
  const Payload length = Payload::Length, compressed = Payload::Compressed;
  return {
    { "ct.nii",
      UseImage,
      { "info ct.nii",
        "crop ct.nii --labels labels.nii.gz -o out/ct.mha --write-labels out/labels.nii.gz",
        "fit ct.nii model_L2.vtu --degree 1 --report out/fit.json -o out/fit.vtu",
        "drr ct.nii --geometry view.json --attenuation -o out/drr.mha" },
      false,
      length,
      SameImage },
    { "ct.nii.gz",
      UseImage,
      { "info ct.nii.gz",
        "contours ct.nii.gz --labels labels.nii.gz --slice-step 6 -o out/contours.vtp -o out/contours.nii.gz",
        "voxels model_L2.vtu --like ct.nii.gz -o out/voxels.nrrd",
        "build ct.nii.gz --labels labels.nii.gz --tetrahedra 500 --degree 1 --levels 0.5 -o out/build",
        "label ct.nii.gz --atlas atlas.h5" + FewHypotheses + "-o out/labels.nii.gz",
        "evaluate surface.ply atlas.h5 --ct ct.nii.gz -o out/evaluation.json" },
      true,
      compressed,
      SameImage },
    { "labels.nii.gz",
      UseLabels,
      { "info labels.nii.gz",
        "crop ct.mha --labels labels.nii.gz -o out/ct.nii.gz",
        "contours ct.mha --labels labels.nii.gz --slice-step 6 -o out/contours.mrk.json",
        "contours ct.mha --init labels.nii.gz --slice-step 6 -o out/contours.vtp",
        "fit ct.mha model_L2.vtu --weights labels.nii.gz --degree 0 -o out/fit.vtu",
        "drr ct.mha --mask labels.nii.gz --geometry view.json -o out/drr.nrrd" },
      true,
      compressed,
      SameImage },
    { "ct.mha",
      UseImage,
      { "info ct.mha",
        "crop ct.mha --labels surface.stl -o out/ct.nii",
        "mesh contours.vtp --ct ct.mha -o out/mesh.vtu",
        "profile model_L2.vtu --ct ct.mha --from 0 17 17 --to 34 17 17 --points 20 -o out/profile.csv" },
      false,
      length,
      SameImage },
    { "labels.mha",
      UseLabels,
      { "info labels.mha", "contours ct.mha --labels labels.mha --slice-step 6 -o out/contours.vtp" },
      false,
      compressed,
      SameImage },
    { "ct.mhd",
      UseImage,
      { "info ct.mhd", "fit ct.mhd model_L2.vtu --degree 0 -o out/fit.vtu" },
      false,
      Payload::Unchecked,
      nullptr,
      { "ct.mhd", "ct.raw" } },
    { "ct.raw",
      With("ct.mhd", UseImage),
      { "info ct.mhd", "crop ct.mhd --labels labels.mha -o out/ct.mha" },
      false,
      length,
      SameHeaderedImage,
      { "ct.mhd", "ct.raw" } },
    { "pair.hdr",
      UseImage,
      { "info pair.hdr", "crop pair.hdr --labels labels.mha -o out/ct.mha" },
      false,
      Payload::Unchecked,
      nullptr,
      { "pair.hdr", "pair.img" } },
    { "pair.img",
      With("pair.hdr", UseImage),
      { "info pair.hdr", "fit pair.img model_L2.vtu --degree 0 -o out/fit.vtu" },
      false,
      length,
      SamePair,
      { "pair.hdr", "pair.img" } },
    { "ct.nrrd",
      UseImage,
      { "info ct.nrrd",
        "crop ct.nrrd --labels labels.nrrd -o out/ct.nrrd",
        "drr ct.nrrd --geometry plastimatch.json -o out/drr.nii.gz" },
      false,
      length,
      SameImage },
    { "labels.nrrd",
      UseLabels,
      { "info labels.nrrd", "contours ct.nrrd --labels labels.nrrd --label 1 --slice-step 6 -o out/contours.vtp" },
      false,
      compressed,
      SameImage },
    { "segments.seg.nrrd",
      UseLabels,
      { "info segments.seg.nrrd", "crop ct.mha --labels segments.seg.nrrd --label Femur -o out/ct.mha" } },
    { "dicom/2.dcm",
      UseFolder,
      { "info dicom",
        "crop dicom --labels labels.nii.gz -o out/ct.mha",
        "fit dicom model_L2.vtu --degree 0 -o out/fit.vtu" },
      false,
      length,
      SameFolder,
      { "dicom" } },
    { "xray.dcm", UseXRay, { "info xray.dcm" }, false, length, SameXRay },
    { "xray_rle.dcm", UseXRay, { "info xray_rle.dcm" } },
    { "xray_jpeg.dcm", UseXRay, { "info xray_jpeg.dcm" } },
    { "xray_jpeg2000.dcm", UseXRay, { "info xray_jpeg2000.dcm" } },
    { "radiograph.mha",
      UseXRay,
      { "info radiograph.mha", Register + "model_L2.vtu --xray radiograph.mha --geometry matrix.json -o out/pose" },
      false,
      length,
      SameXRay },
    { "names.csv",
      UseLabelTable,
      { "crop ct.mha --labels labels.mha --label-names names.csv --label 1 -o out/ct.mha" } },
    { "names.json",
      UseLabelTable,
      { "contours ct.mha --labels labels.mha --label-names names.json --label left --slice-step 6 -o out/c.vtp" } }
  };
}

std::vector<FuzzFormat>
ShapeFormats()
{
  return { { "contours.vtp",
             UseContours,
             { "info contours.vtp",
               "mesh contours.vtp --write-correspondence out/correspondence.json -o out/mesh.vtu",
               "smooth model_L1.vtu --contours contours.vtp -o out/smooth.vtu",
               "contours ct.mha --init contours.vtp --slice-step 6 -o out/contours.vtp" },
             false,
             Payload::Base64,
             SameContours },
           { "contours.mrk.json",
             UseContours,
             { "info contours.mrk.json",
               "contours ct.mha --init contours.mrk.json --slice-step 6 -o out/contours.vtp" } },
           { "structures.dcm",
             UseStructures,
             { "contours ct.mha --init structures.dcm --slice-step 6 -o out/contours.vtp",
               "contours ct.mha --init structures.dcm --structure femur --slice-step 6 -o out/contours.mrk.json" } },
           { "surface.vtp", UseSurface, { "info surface.vtp", "crop ct.mha --labels surface.vtp -o out/ct.mha" } },
           { "surface.stl",
             UseSurface,
             { "info surface.stl", "contours ct.mha --labels surface.stl --slice-step 6 -o out/contours.vtp" } },
           { "surface.ply", UseSurface, { "info surface.ply", "crop ct.mha --labels surface.ply -o out/ct.mha" } },
           { "corner.ply",
             UseSurface,
             { "phantom --surface corner.ply --spacing 4 --margin 1 -o out/ct.mha --labels out/labels.mha" } },
           { "surface_binary.stl",
             UseSurface,
             { "info surface_binary.stl", "crop ct.mha --labels surface_binary.stl -o out/ct.mha" } },
           { "surface_binary.ply",
             UseSurface,
             { "info surface_binary.ply", "crop ct.mha --labels surface_binary.ply -o out/ct.mha" } },
           { "model_L1.vtu",
             UseMesh,
             { "info model_L1.vtu",
               "validate model_L1.vtu",
               "smooth model_L1.vtu -o out/smooth.vtu",
               "smooth model_L1.vtu --method laplacian --iterations 2 -o out/smooth.vtu",
               "simplify model_L1.vtu --levels 0.5 -o out/model",
               "drr model_L1.vtu --geometry matrix.json -o out/drr.mha",
               "voxels model_L1.vtu --spacing 4 -o out/voxels.mha",
               "profile model_L1.vtu --from 0 17 17 --to 34 17 17 --points 20 -o out/profile.csv",
               "calibrate model_L1.vtu --line 0.001 0.1 --to ash -o out/ash.vtu",
               "fit ct.mha model_L1.vtu --degree 1 -o out/fit.vtu",
               "measure model_L1.vtu --landmarks landmarks.mrk.json --ball 17 17 17 5 -o out/measures.json",
               "plan model_L1.vtu --resection 17 17 17 0 0 1 --path 17 17 30 17 17 24 --radius 2 -o out/plan.json",
               "evaluate model_L1.vtu atlas.h5 -o out/evaluation.json",
               "export model_L1.vtu --format gmsh --law keyak1998 --line 0 0.001 -o out/mesh.msh",
               Register + "model_L1.vtu --xray radiograph.mha --geometry matrix.json -o out/pose" },
             false,
             Payload::Base64,
             SameMesh },
           { "compact.vtu",
             UseMesh,
             { "info compact.vtu", "calibrate compact.vtu --line 0.001 0.1 --to ash -o out/ash.vtu" },
             false,
             Payload::Base64,
             SameMesh },
           { "model_L2.vtu",
             With("model.hierarchy.json", UseHierarchy),
             { "info model.hierarchy.json" },
             false,
             Payload::Base64,
             SameMesh,
             { "model.hierarchy.json", "model_L2.vtu" } },
           { "model.hierarchy.json",
             UseHierarchy,
             { "info model.hierarchy.json" },
             false,
             Payload::Unchecked,
             nullptr,
             { "model.hierarchy.json", "model_L2.vtu" } },
           { "correspondence.json",
             UseCorrespondence,
             { "mesh contours.vtp --correspondence correspondence.json -o out/mesh.vtu" } } };
}

std::vector<FuzzFormat>
OtherFormats()
{
  return {
    { "view.json",
      UseGeometry,
      { "info view.json",
        "drr model_L2.vtu --geometry view.json -o out/drr.mha",
        "drr ct.mha --geometry view.json --save-geometry out/matrix.json --convention matrix -o out/drr.mha" } },
    { "matrix.json",
      UseGeometry,
      { "info matrix.json",
        "drr model_L2.vtu --geometry matrix.json --save-geometry out/g.json --convention plastimatch -o "
        "out/drr.mha" } },
    { "plastimatch.json",
      UseGeometry,
      { "info plastimatch.json",
        "drr model_L2.vtu --geometry plastimatch.json --save-geometry out/g.xml --convention rtk -o out/drr.mha" } },
    { "geometry.xml",
      With("rtk.json", UseGeometry),
      { "info rtk.json", "drr model_L2.vtu --geometry rtk.json -o out/drr.mha" },
      false,
      Payload::Unchecked,
      nullptr,
      { "rtk.json", "geometry.xml" } },
    { "rtk.json",
      UseGeometry,
      { "info rtk.json", "drr model_L2.vtu --geometry rtk.json -o out/drr.mha" },
      false,
      Payload::Unchecked,
      nullptr,
      { "rtk.json", "geometry.xml" } },
    { "atlas.h5",
      UseAtlas,
      { "info atlas.h5",
        "sample atlas.h5 --shape 1=1 -o out/sample.vtu",
        "sample atlas.h5 --random 7 -o out/sample.vtu",
        "evaluate subject.vtu atlas.h5 -o out/evaluation.json",
        "register volume atlas.h5 ct.mha" + FewHypotheses + "-o out/bone",
        "register deform atlas.h5 --xray radiograph.mha radiograph.mha --geometry view.json --search 0 0 --pixels 32 "
        "--search-pixels 32 --iterations 1 --smooth-modes 0 --no-intensities --no-collimator -o out/bone" },
      false,
      Payload::Length,
      SameModel },
    { "subjects.txt", UseSubjects, { "train subjects.txt --degree 0 -o out/atlas.h5" } },
    { "pose.tfm",
      UseTransform,
      { Register + "model_L2.vtu --xray radiograph.mha --geometry matrix.json --initial pose.tfm -o out/pose" } },
    { "landmarks.mrk.json",
      UseLandmarks,
      { "measure model_L2.vtu --landmarks landmarks.mrk.json -o out/measures.json --write-landmarks "
        "out/placed.mrk.json",
        Register + "model_L2.vtu --xray radiograph.mha --geometry matrix.json --landmarks landmarks.mrk.json "
                   "--xray-landmarks points.json -o out/pose" } },
    { "points.json",
      UseImageLandmarks,
      { Register + "model_L2.vtu --xray radiograph.mha --geometry matrix.json --landmarks landmarks.mrk.json "
                   "--xray-landmarks points.json -o out/pose" } },
    { "references.json",
      nullptr,
      { "calibrate model_L2.vtu --references references.json --ct ct.mha --labels labels.mha --to k2hpo4 -o "
        "out/m.vtu" } },
    { "report.json", UseParameters, { "build --parameters report.json -o out/build" } }
  };
}
} // namespace

std::vector<FuzzFormat>
FuzzFormats()
{
  std::vector<FuzzFormat> all = ImageFormats();
  for (const auto & more : { ShapeFormats(), OtherFormats() })
  {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}
} // namespace bone
