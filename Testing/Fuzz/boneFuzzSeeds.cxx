/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFuzzSeeds.h"

#include "boneAtomicFile.h"
#include "boneBuildPipeline.h"
#include "boneBuildPlan.h"
#include "boneContourIO.h"
#include "boneCorrespondenceIO.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneImageIO.h"
#include "boneLandmarkIO.h"
#include "boneMeshIO.h"
#include "boneModelIO.h"
#include "boneStatisticalModelEstimator.h"
#include "boneTestDicom.h"
#include "boneTestStructures.h"
#include "boneTransformIO.h"

#include <Eigen/Eigenvalues> // stands for the older one of ITK's own that its image formats bring

#include <itkEuler3DTransform.h>
#include <itkGDCMImageIO.h>
#include <itkImageFileWriter.h>
#include <itkMath.h>
#include <itkMetaDataObject.h>
#include <itkNiftiImageIO.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace bone
{
namespace
{
constexpr int Size = 18;

/** A ball of bone with a core: values of the CT, or labels, at 2 mm. */
template <typename TImage>
typename TImage::Pointer
MakeBall(double shell, double core, double rest)
{
  auto                        image = TImage::New();
  typename TImage::SizeType   size{ { Size, Size, Size } };
  typename TImage::RegionType region(size);
  image->SetRegions(region);
  image->SetSpacing(itk::Vector<double, 3>(2.0));
  image->Allocate();
  for (int z = 0; z < Size; ++z)
  {
    for (int y = 0; y < Size; ++y)
    {
      for (int x = 0; x < Size; ++x)
      {
        const double r = Vector3(x - 8.5, y - 8.4, z - 8.3).norm();
        image->SetPixel({ { x, y, z } },
                        static_cast<typename TImage::PixelType>(r > 7.0   ? rest
                                                                : r > 4.5 ? shell
                                                                          : core));
      }
    }
  }
  return image;
}

void
WriteText(const std::string & path, const std::string & text)
{
  std::ofstream(path, std::ios::binary) << text;
}

/** Two overlapping segments of 3D Slicer: the ball, and its half. */
void
WriteSegments(const LabelImage * labels, const std::string & path)
{
  std::string text = "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 18 18 18\n"
                     "space directions: none (2,0,0) (0,2,0) (0,0,2)\nkinds: list domain domain domain\n"
                     "encoding: raw\nspace origin: (0,0,0)\nSegment0_ID:=Segment_1\nSegment0_Name:=Femur\n"
                     "Segment0_Layer:=0\nSegment0_LabelValue:=1\nSegment1_ID:=Segment_2\nSegment1_Name:=Half\n"
                     "Segment1_Layer:=1\nSegment1_LabelValue:=1\n\n";
  for (int i = 0; i < Size * Size * Size; ++i)
  {
    const auto label = static_cast<char>(labels->GetBufferPointer()[i]);
    text += { label, i % Size < Size / 2 ? label : '\0' };
  }
  WriteText(path, text);
}

/** One DICOM image of GDCM's, with these attributes. */
void
WriteDicom(const LabelImage *                                        image,
           const std::vector<std::pair<const char *, std::string>> & attributes,
           const std::string &                                       path)
{
  auto io = itk::GDCMImageIO::New();
  auto slice = LabelImage::New();
  slice->Graft(image);
  for (const auto & [key, text] : attributes)
  {
    itk::EncapsulateMetaData<std::string>(slice->GetMetaDataDictionary(), key, text);
  }
  io->KeepOriginalUIDOn();
  auto writer = itk::ImageFileWriter<LabelImage>::New();
  writer->SetImageIO(io);
  writer->SetInput(slice);
  writer->SetFileName(path);
  writer->Update();
}

LabelImage::Pointer
SliceOf(const CTImage * ct, int z)
{
  auto image = LabelImage::New();
  image->SetRegions(LabelImage::SizeType{ { Size, Size, 1 } });
  image->SetSpacing(ct->GetSpacing());
  image->Allocate();
  for (int i = 0; i < Size * Size; ++i)
  {
    image->GetBufferPointer()[i] = static_cast<short>(ct->GetBufferPointer()[z * Size * Size + i]);
  }
  return image;
}

/** The CT as a series, and a slice of it as a radiograph, plain and compressed. */
void
WriteDicoms(const CTImage * ct, const std::string & folder)
{
  std::filesystem::create_directory(folder + "/dicom");
  const auto common = [](const char * storage, const char * modality) {
    return std::vector<std::pair<const char *, std::string>>{ { "0008|0016", storage },
                                                              { "0008|0060", modality },
                                                              { "0028|0004", "MONOCHROME2" },
                                                              { "0020|000d", "1.2.826.0.1.3680043.2.1125.1" },
                                                              { "0020|000e", "1.2.826.0.1.3680043.2.1125.1.1" } };
  };
  for (int z = 0; z < Size; ++z)
  {
    auto attributes = common("1.2.840.10008.5.1.4.1.1.2", "CT");
    attributes.emplace_back("0020|0032", "0\\0\\" + std::to_string(2 * z));
    attributes.emplace_back("0020|0037", "1\\0\\0\\0\\1\\0");
    WriteDicom(SliceOf(ct, z), attributes, folder + "/dicom/" + std::to_string(z) + ".dcm");
  }
  WriteDicom(SliceOf(ct, Size / 2), common("1.2.840.10008.5.1.4.1.1.1.1", "DX"), folder + "/xray.dcm");
  using Syntax = gdcm::TransferSyntax;
  TransferDicom(folder + "/xray.dcm", Syntax::RLELossless, folder + "/xray_rle.dcm");
  TransferDicom(folder + "/xray.dcm", Syntax::JPEGLosslessProcess14_1, folder + "/xray_jpeg.dcm");
  TransferDicom(folder + "/xray.dcm", Syntax::JPEG2000Lossless, folder + "/xray_jpeg2000.dcm");
}

/** The surface as ASCII STL and PLY, and as VTK's XML by way of text. */
void
WriteSurface(const TriangleSurface & surface, const std::string & folder)
{
  std::ostringstream stl, ply, vtp;
  stl << "solid SPACE=LPS\n";
  ply << "ply\nformat ascii 1.0\nelement vertex " << surface.points.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << surface.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  vtp << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData>\n"
         "<Piece NumberOfPoints=\""
      << surface.points.size() << "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\""
      << surface.triangles.size()
      << "\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (const Vector3 & p : surface.points)
  {
    ply << p.transpose() << '\n';
    vtp << p.transpose() << '\n';
  }
  vtp << "</DataArray></Points>\n<Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n";
  for (const auto & t : surface.triangles)
  {
    stl << "facet normal 0 0 0\nouter loop\n";
    for (const IdType p : t)
    {
      stl << "vertex " << surface.points[static_cast<std::size_t>(p)].transpose() << '\n';
    }
    stl << "endloop\nendfacet\n";
    ply << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
    vtp << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  }
  stl << "endsolid\n";
  vtp << "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
  for (std::size_t t = 1; t <= surface.triangles.size(); ++t)
  {
    vtp << 3 * t << '\n';
  }
  vtp << "</DataArray></Polys></Piece></PolyData></VTKFile>\n";
  WriteText(folder + "/surface.stl", stl.str());
  WriteText(folder + "/surface.ply", ply.str());
  WriteText(folder + "/surface.vtp", vtp.str());
}

template <typename T>
void
Append(std::string & bytes, T value)
{
  bytes.append(reinterpret_cast<const char *>(&value), sizeof value);
}

/** The same as binary STL and PLY. */
void
WriteBinarySurface(const TriangleSurface & surface, const std::string & folder)
{
  std::string stl(80, ' ');
  Append(stl, static_cast<std::uint32_t>(surface.triangles.size()));
  std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(surface.points.size()) +
                    "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                    std::to_string(surface.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vector3 & p : surface.points)
  {
    for (int k = 0; k < 3; ++k)
    {
      Append(ply, p[k]);
    }
  }
  for (const auto & t : surface.triangles)
  {
    stl.append(12, '\0');
    Append(ply, std::uint8_t{ 3 });
    for (const IdType id : t)
    {
      for (int k = 0; k < 3; ++k)
      {
        Append(stl, static_cast<float>(surface.points[static_cast<std::size_t>(id)][k]));
      }
      Append(ply, static_cast<std::int32_t>(id));
    }
    stl.append(2, '\0');
  }
  WriteText(folder + "/surface_binary.stl", stl);
  WriteText(folder + "/surface_binary.ply", ply);
}

/** The mesh as subject number i of a population. */
MeshArrays
SubjectOf(MeshArrays mesh, int i)
{
  for (Vector3 & p : mesh.points)
  {
    p.z() *= 1.0 + 0.05 * i;
  }
  for (double & c : mesh.coefficients)
  {
    c += 50.0 * (i % 2);
  }
  return mesh;
}

void
WriteAtlas(const DensityMesh<double> * mesh, const std::string & path)
{
  auto set = MeshTrainingSet<>::New();
  for (int i = 0; i < 3; ++i)
  {
    auto subject = DensityMesh<double>::New();
    subject->SetArrays(SubjectOf(mesh->GetArrays(), i));
    set->AddSubject(std::to_string(i), subject);
  }
  auto estimator = StatisticalModelEstimator<>::New();
  estimator->SetInput(set);
  estimator->CombinedOn();
  estimator->Update();
  WriteStatisticalModel(estimator->GetOutput(), path);
}

void
WriteImages(const CTImage * ct, const LabelImage * labels, const std::string & folder)
{
  for (const char * name : { "ct.nii", "ct.nii.gz", "ct.mha", "ct.mhd", "ct.nrrd" })
  {
    WriteImage(ct, folder + "/" + name);
  }
  for (const char * name : { "labels.nii.gz", "labels.mha", "labels.nrrd" }) // compressed
  {
    WriteImage(labels, folder + "/" + name);
  }
  auto pair = itk::ImageFileWriter<CTImage>::New(); // as two files, which BoneTK reads and does not write
  pair->SetImageIO(itk::NiftiImageIO::New());
  pair->SetInput(ct);
  pair->SetFileName(folder + "/pair.hdr");
  pair->Update();
  WriteSegments(labels, folder + "/segments.seg.nrrd");
  WriteDicoms(ct, folder);
}

/** The ball as a structure of circles. */
void
WriteStructureSet(const std::string & path)
{
  constexpr int    corners = 16;
  constexpr double radius = 14.0;
  const Vector3    centre(17.0, 16.8, 16.6);
  Structure        ball{ "femur", {} };
  for (int k = 3; k <= 13; ++k)
  {
    const double         z = 2.0 * k;
    const double         r = std::sqrt(radius * radius - (z - centre.z()) * (z - centre.z()));
    std::vector<Vector3> circle;
    for (int i = 0; i < corners; ++i)
    {
      const double angle = 2.0 * itk::Math::pi * i / corners;
      circle.emplace_back(centre.x() + r * std::cos(angle), centre.y() + r * std::sin(angle), z);
    }
    ball.contours.push_back(circle);
  }
  WriteStructures(path, { ball }, "RTSTRUCT");
}

void
WriteTexts(const std::string & folder)
{
  WriteText(folder + "/names.csv", "value,name\n1,left femur\n2,\"right femur\"\n");
  WriteText(folder + "/names.json", R"({"labels": {"background": 0, "left": 1, "right": 2}})");
  WriteText(folder + "/subjects.txt", "# shape, CT\nmodel_L1.vtu, ct.nii.gz\nsubject.vtu, ct.mha\n");
  WriteText(folder + "/references.json",
            R"({"references": [{"name": "water", "density": 0, "value": 0},
                {"name": "core", "density": 150, "label": 1},
                {"name": "rod", "density": 800, "from": [17, 17, 4], "to": [17, 17, 8], "radius": 2}]})");
  WriteText(folder + "/corner.ply",
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n"
            "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  WriteText(folder + "/rtk.json", R"({"rtk": "geometry.xml", "size": [20, 20], "spacing": [2, 2]})");
}
/** What registration begins with: a pose, landmarks, and where they lie on the view. */
void
WritePose(const XRayGeometry & view, const std::string & folder)
{
  auto pose = itk::Euler3DTransform<double>::New();
  pose->SetRotation(0.02, -0.01, 0.03);
  WriteRigidTransform(*pose, folder + "/pose.tfm");
  const std::vector<Landmark> landmarks = {
    { "top", { 17, 17, 30 } }, { "front", { 17, 4, 17 } }, { "left", { 30, 17, 16 } }, { "low", { 12, 20, 5 } }
  };
  WriteLandmarks(landmarks, folder + "/landmarks.mrk.json");
  std::string points;
  for (const Landmark & landmark : landmarks)
  {
    const Vector2 p = view.ProjectPoint(landmark.point);
    points += (points.empty() ? "{\"" : ", \"") + landmark.name + "\": [" + std::to_string(p.x()) + ", " +
              std::to_string(p.y()) + "]";
  }
  WriteText(folder + "/points.json", points + "}");
}
} // namespace

void
WriteFuzzSeeds(const std::string & folder)
{
  const auto ct = MakeBall<CTImage>(900.0, 200.0, -50.0);
  const auto labels = MakeBall<LabelImage>(1.0, 1.0, 0.0);
  WriteImages(ct, labels, folder);
  WriteTexts(folder);
  WriteStructureSet(folder + "/structures.dcm");

  BuildPipeline pipeline(2);
  pipeline.SetImage(ct);
  pipeline.SetLabelImage(labels);
  pipeline.GetSnake()->SetSliceStep(6.0);
  pipeline.SetContourSpacing(8.0);
  pipeline.GetFit()->SetDegree(1);
  pipeline.GetQuality()->Update();
  const IdType count = pipeline.GetQuality()->GetOutput()->GetNumberOfTetrahedra();
  pipeline.GetCollapse()->SetLevels({ count * 2 / 3 });
  const XRayGeometry::Pointer view = FrontView(pipeline.GetQuality()->GetOutput());
  pipeline.SetGeometry(view);
  pipeline.Update();
  WriteContours(pipeline.GetMedialAxis()->GetOutput(), folder + "/contours.vtp");
  WriteContours(pipeline.GetMedialAxis()->GetOutput(), folder + "/contours.mrk.json");
  WriteHierarchy(pipeline.GetCollapse()->GetOutput(), folder + "/model");
  WriteCorrespondence(pipeline.GetTiling()->GetReport().correspondence, folder + "/correspondence.json");
  WriteGeometry({ view, view }, folder + "/view.json");
  WriteGeometry({ view }, folder + "/matrix.json", GeometryConvention::Matrix);
  WriteGeometry({ view }, folder + "/plastimatch.json", GeometryConvention::Plastimatch);
  WriteRtkGeometry({ view }, folder + "/geometry.xml");
  WriteImage(pipeline.GetRadiograph(1)->GetOutput(), folder + "/radiograph.mha");
  WritePose(*view, folder);
  BuildParameters parameters;
  pipeline.GetParameters(parameters);
  parameters.plan.tetrahedra = 500;
  parameters.plan.levels = { 0.5 };
  WriteText(folder + "/report.json",
            R"({"input": {"image": "ct.nii.gz", "labels": "labels.nii.gz"}, "parameters": )" + ToJson(parameters) +
              "}");
  const auto            level = ReadDensityMesh(folder + "/model_L1.vtu");
  std::vector<IdType>   ids;
  const TriangleSurface surface = ExteriorSurface(level->GetArrays(), ids);
  WriteSurface(surface, folder);
  WriteBinarySurface(surface, folder);
  WriteMeshArrays(SubjectOf(level->GetArrays(), 1), folder + "/subject.vtu");
  MeshStorageParameters compact;
  compact.compact = true;
  WriteMeshArrays(level->GetArrays(), folder + "/compact.vtu", compact);
  WriteAtlas(level, folder + "/atlas.h5");
}
} // namespace bone
