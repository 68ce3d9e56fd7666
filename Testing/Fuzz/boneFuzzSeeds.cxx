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
#include "boneMeshIO.h"
#include "boneModelIO.h"
#include "boneStatisticalModelEstimator.h"

#include <Eigen/Eigenvalues> // stands for the older one of ITK's own that its image formats bring

#include <itkGDCMImageIO.h>
#include <itkImageFileWriter.h>
#include <itkMetaDataObject.h>

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

/** Two overlapping segments of 3D Slicer. */
void
WriteSegments(const std::string & path)
{
  std::string text = "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 6 5 4\n"
                     "space directions: none (1,0,0) (0,1,0) (0,0,2)\nkinds: list domain domain domain\n"
                     "encoding: raw\nspace origin: (0,0,0)\nSegment0_ID:=Segment_1\nSegment0_Name:=Femur\n"
                     "Segment0_Layer:=0\nSegment0_LabelValue:=1\nSegment1_ID:=Segment_2\nSegment1_Name:=Bone\n"
                     "Segment1_Layer:=1\nSegment1_LabelValue:=1\n\n";
  for (int i = 0; i < 6 * 5 * 4; ++i)
  {
    text += { static_cast<char>(i % 6 > 2), static_cast<char>(i % 6 > 1) };
  }
  WriteText(path, text);
}

void
WriteDicomSlices(const std::string & folder)
{
  std::filesystem::create_directory(folder);
  for (int k = 0; k < 4; ++k)
  {
    auto image = LabelImage::New();
    image->SetRegions(LabelImage::SizeType{ { 7, 6, 1 } });
    image->Allocate();
    image->FillBuffer(static_cast<short>(100 * k));
    auto       io = itk::GDCMImageIO::New();
    const auto put = [&image](const char * key, const std::string & text) {
      itk::EncapsulateMetaData<std::string>(image->GetMetaDataDictionary(), key, text);
    };
    put("0008|0016", "1.2.840.10008.5.1.4.1.1.2");
    put("0008|0060", "CT");
    put("0028|0004", "MONOCHROME2");
    put("0020|000d", "1.2.826.0.1.3680043.2.1125.1");
    put("0020|000e", "1.2.826.0.1.3680043.2.1125.1.1");
    put("0020|0032", "0\\0\\" + std::to_string(2 * k));
    put("0020|0037", "1\\0\\0\\0\\1\\0");
    io->KeepOriginalUIDOn();
    auto writer = itk::ImageFileWriter<LabelImage>::New();
    writer->SetImageIO(io);
    writer->SetInput(image);
    writer->SetFileName(folder + "/" + std::to_string(k) + ".dcm");
    writer->Update();
  }
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

void
WriteAtlas(const DensityMesh<double> * mesh, const std::string & path)
{
  auto set = MeshTrainingSet<>::New();
  for (int i = 0; i < 3; ++i)
  {
    MeshArrays arrays = mesh->GetArrays();
    for (Vector3 & p : arrays.points)
    {
      p.z() *= 1.0 + 0.05 * i;
    }
    for (double & c : arrays.coefficients)
    {
      c += 50.0 * (i % 2);
    }
    auto subject = DensityMesh<double>::New();
    subject->SetArrays(std::move(arrays));
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
  WriteSegments(folder + "/segments.seg.nrrd");
  WriteDicomSlices(folder + "/dicom");
}

void
WriteTexts(const std::string & folder)
{
  WriteText(folder + "/names.csv", "value,name\n1,left femur\n2,\"right femur\"\n");
  WriteText(folder + "/names.json", R"({"labels": {"background": 0, "left": 1, "right": 2}})");
  WriteText(folder + "/subjects.txt", "# shape, CT\nmodel_L1.vtu, ct.nii.gz\nmodel_L2.vtu\n");
  WriteText(folder + "/rtk.json", R"({"rtk": "geometry.xml", "size": [20, 20], "spacing": [2, 2]})");
}
} // namespace

void
WriteFuzzSeeds(const std::string & folder)
{
  const auto ct = MakeBall<CTImage>(900.0, 200.0, -50.0);
  const auto labels = MakeBall<LabelImage>(1.0, 1.0, 0.0);
  WriteImages(ct, labels, folder);
  WriteTexts(folder);

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
  BuildParameters parameters;
  pipeline.GetParameters(parameters);
  WriteText(folder + "/report.json",
            "{\"input\": {\"image\": \"ct.nii.gz\"}, \"parameters\": " + ToJson(parameters) + "}");
  const auto            level = ReadDensityMesh(folder + "/model_L1.vtu");
  std::vector<IdType>   ids;
  const TriangleSurface surface = ExteriorSurface(level->GetArrays(), ids);
  WriteSurface(surface, folder);
  WriteBinarySurface(surface, folder);
  WriteAtlas(level, folder + "/atlas.h5");
}
} // namespace bone
