/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshIO.h"

#include "boneMeshValidator.h"
#include "boneTestFiles.h"
#include "boneTestMeshes.h"

#include <limits>

namespace bone
{
using testing::HasSubstr;
using testing::IsEmpty;

namespace MeshIOTests
{
void
ExpectSame(const MeshArrays & a, const MeshArrays & b)
{
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.tetrahedra, b.tetrahedra);
  EXPECT_EQ(a.neighbors, b.neighbors);
  EXPECT_EQ(a.layer, b.layer);
  EXPECT_EQ(a.slice, b.slice);
  EXPECT_EQ(a.region, b.region);
  EXPECT_EQ(a.degree, b.degree);
  EXPECT_EQ(a.coefficients, b.coefficients);
  EXPECT_EQ(a.maximumDegree, b.maximumDegree);
  EXPECT_EQ(a.quantity, b.quantity);
}

// One tetrahedron as ASCII .vtu with the given pieces put in.
struct Vtu
{
  std::string points{ "0 0 0 1 0 0 0 1 0 0 0 1" };
  std::string connectivity{ "0 1 2 3" };
  std::string offsets{ "4" };
  std::string types{ "10" };
  std::string cellData;
  std::string fieldData;
  int         numberOfPoints{ 4 };
  int         numberOfCells{ 1 };

  std::string
  Text() const
  {
    return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>" +
           (fieldData.empty() ? "" : "<FieldData>" + fieldData + "</FieldData>") + "<Piece NumberOfPoints=\"" +
           std::to_string(numberOfPoints) + "\" NumberOfCells=\"" + std::to_string(numberOfCells) +
           "\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">" + points +
           "</DataArray></Points><Cells>" + "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" +
           connectivity + "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">" + offsets +
           "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">" + types +
           "</DataArray></Cells><CellData>" + cellData + "</CellData></Piece></UnstructuredGrid></VTKFile>";
  }
};

std::string
Array(const std::string & name, const std::string & type, int components, const std::string & values)
{
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" + std::to_string(components) +
         "\" NumberOfTuples=\"1\" format=\"ascii\">" + values + "</DataArray>";
}

class MeshIOTest : public FileTest
{
protected:
  std::string
  ErrorOfReading(const std::string & text)
  {
    WriteText("m.vtu", text);
    return ErrorOf([&] { ReadMeshArrays(Path("m.vtu")); });
  }
};

TEST_F(MeshIOTest, EveryDegreeIsReadAsWritten)
{
  for (int degree = 0; degree <= MaximumBernsteinDegree; ++degree)
  {
    const auto mesh = DensityBox({ degree });
    WriteMeshArrays(mesh, Path("m.vtu"));
    ExpectSame(ReadMeshArrays(Path("m.vtu")), mesh);
  }
  EXPECT_THAT(Files(), testing::ElementsAre("m.vtu"));
}

TEST_F(MeshIOTest, MixedDegreesAreReadAsWritten)
{
  const auto mesh = DensityBox({ 3, 0, 8, 1 });
  WriteMeshArrays(mesh, Path("m.vtu"));
  ExpectSame(ReadMeshArrays(Path("m.vtu")), mesh);
}

TEST_F(MeshIOTest, AMeshWithoutAttributesIsReadWithItsNeighbours)
{
  MeshArrays mesh = DensityBox({});
  EXPECT_TRUE(ValidateMesh(mesh).IsValid()) << ValidateMesh(mesh).Summary();
  const auto neighbors = mesh.neighbors;
  mesh.layer.clear();
  mesh.slice.clear();
  mesh.region.clear();
  mesh.neighbors.clear();
  WriteMeshArrays(mesh, Path("m.vtu"));
  mesh.neighbors = neighbors;
  ExpectSame(ReadMeshArrays(Path("m.vtu")), mesh);
}

TEST_F(MeshIOTest, DoubleAndFloatMeshesAreReadAsWritten)
{
  const auto arrays = DensityBox({ 2 });
  auto       mesh = DensityMesh<double>::New();
  mesh->SetArrays(arrays);
  WriteDensityMesh(mesh.GetPointer(), Path("d.vtu"));
  ExpectSame(ReadDensityMesh(Path("d.vtu"))->GetArrays(), arrays);

  auto single = DensityMesh<float>::New();
  single->SetArrays(arrays);
  WriteDensityMesh(single.GetPointer(), Path("f.vtu"));
  ExpectSame(ReadDensityMesh(Path("f.vtu"))->GetArrays(), single->GetArrays());
}

TEST_F(MeshIOTest, ReadsAPlainAsciiFileOfOtherTypes)
{
  Vtu vtu;
  vtu.cellData = Array("Region", "Float64", 1, "2") + Array("DensityCoefficients", "Float32", 4, "1 2 3 4");
  vtu.fieldData = Array("DensityQuantity", "Int64", 1, "4");
  WriteText("m.VTU", vtu.Text());
  const auto mesh = ReadMeshArrays(Path("m.VTU"));
  EXPECT_EQ(mesh.tetrahedra, std::vector<Id4>(1, Id4{ 0, 1, 2, 3 }));
  EXPECT_EQ(mesh.neighbors, std::vector<Id4>(1, Id4{ -1, -1, -1, -1 }));
  EXPECT_EQ(mesh.region, std::vector<int>{ 2 });
  EXPECT_EQ(mesh.maximumDegree, 1);
  EXPECT_EQ(mesh.degree, std::vector<int>{ 1 });
  EXPECT_EQ(mesh.coefficients, (std::vector<double>{ 1, 2, 3, 4 }));
  EXPECT_EQ(mesh.quantity, DensityQuantity::AshGramPerCubicCentimetre);
}

TEST_F(MeshIOTest, RefusesMissingEmptyAndMisnamedFiles)
{
  EXPECT_THAT(ErrorOf([&] { ReadMeshArrays(Path("no.vtu")); }), HasSubstr("no.vtu: there is no such file"));
  EXPECT_THAT(ErrorOf([&] { ReadMeshArrays(m_Folder.string()); }), HasSubstr("is a folder"));
  EXPECT_THAT(ErrorOfReading(""), HasSubstr("m.vtu: is empty"));
  WriteText("m.vtk", "# vtk DataFile Version 2.0");
  EXPECT_THAT(ErrorOf([&] { ReadMeshArrays(Path("m.vtk")); }), HasSubstr("must end in .vtu"));
}

TEST_F(MeshIOTest, RefusesWhatIsNoXmlOrBrokenXml)
{
  EXPECT_THAT(ErrorOfReading("This is a text."), HasSubstr("is no readable VTK unstructured grid"));
  const std::string good = Vtu().Text();
  for (std::size_t length : { good.size() / 4, good.size() / 2, good.size() - 10 })
  {
    EXPECT_THAT(ErrorOfReading(good.substr(0, length)), HasSubstr("is no readable VTK unstructured grid"));
  }
  EXPECT_THAT(ErrorOfReading("<VTKFile type=\"PolyData\" version=\"0.1\"><PolyData/></VTKFile>"), HasSubstr("m.vtu: "));
}

TEST_F(MeshIOTest, RefusesATruncatedBinaryFile)
{
  WriteMeshArrays(DensityBox({ 3 }), Path("m.vtu"));
  const std::string good = ReadText("m.vtu");
  for (double part : { 0.3, 0.6, 0.9, 0.99 })
  {
    EXPECT_THAT(ErrorOfReading(good.substr(0, static_cast<std::size_t>(part * good.size()))), HasSubstr("m.vtu: "));
  }
  std::string garbled = good;
  for (std::size_t i = good.size() / 3; i < good.size() / 3 + 200; ++i)
  {
    garbled[i] = 'A';
  }
  EXPECT_THAT(ErrorOfReading(garbled), HasSubstr("m.vtu: "));
}

TEST_F(MeshIOTest, RefusesArraysThatAreTooShortOrOfNoKnownType)
{
  Vtu vtu;
  vtu.cellData = Array("Region", "Int32", 1, "");
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("\"Region\""));
  vtu.cellData = Array("Region", "Int3C", 1, "1");
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("m.vtu: "));
  vtu = Vtu();
  vtu.fieldData = Array("DensityQuantity", "Int3C", 1, "1");
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("field data array is of no known type"));
  vtu = Vtu();
  vtu.numberOfPoints = 2000000000;
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("m.vtu: "));
}

TEST_F(MeshIOTest, RefusesCountsThatTheFileCannotHold)
{
  WriteMeshArrays(DensityBox({ 3 }), Path("m.vtu"));
  const std::string good = ReadText("m.vtu");
  const auto        error = [&](const std::string & from, const std::string & to) {
    std::string text = good;
    EXPECT_NE(text.find(from), std::string::npos) << from;
    return ErrorOfReading(text.replace(text.find(from), from.size(), to));
  };
  for (const char * count : { "-1e300", "-1", "nan", "1e15", "99999999999999999999", "0x10", "" })
  {
    EXPECT_THAT(error("NumberOfPoints=\"", std::string("NumberOfPoints=\"") + count + "\" x=\""),
                HasSubstr("m.vtu: is damaged: 'NumberOfPoints' of 'Piece' is"))
      << count;
  }
  EXPECT_THAT(error("NumberOfComponents=\"4\"", "NumberOfComponents=\"4294967296\""),
              HasSubstr("'NumberOfComponents'"));
  // The number of blocks of a compressed array, the first eight bytes of its text.
  EXPECT_THAT(error("AQAAAAAAAAA", "AQAAAAAAAH8"), HasSubstr("m.vtu: is "));
  EXPECT_THAT(error("AQAAAAAAAAAA", "AQAAAAAAAAAA////////"), HasSubstr("m.vtu: is "));
  EXPECT_THAT(error("AQAAAAAAAAAAgAAAAAAAA", "AQAAAAAAAAAAAAAAAAAAA"), HasSubstr("m.vtu: is ")); // their size
  std::string vectors = good; // an array that has elements within
  vectors.replace(good.find("AQAAAAAAAAAA", good.find("Name=\"Points\"")), 10, "AQAAAAAAAUA");
  EXPECT_THAT(ErrorOfReading(vectors), HasSubstr("m.vtu: is "));
}

TEST_F(MeshIOTest, RefusesCellsThatAreNoLinearTetrahedraAndSaysWhich)
{
  Vtu hexahedron;
  hexahedron.numberOfPoints = 8;
  hexahedron.points = "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1";
  hexahedron.connectivity = "0 1 2 3 4 5 6 7  0 1 2 4";
  hexahedron.offsets = "8 12";
  hexahedron.types = "12 10";
  hexahedron.numberOfCells = 2;
  EXPECT_THAT(ErrorOfReading(hexahedron.Text()),
              testing::AllOf(HasSubstr("no linear tetrahedra"), HasSubstr("1 vtkHexahedron (VTK type 12)")));
  Vtu none;
  none.numberOfCells = 0;
  none.connectivity = none.offsets = none.types = "";
  EXPECT_THAT(ErrorOfReading(none.Text()), HasSubstr("no tetrahedra"));
}

TEST_F(MeshIOTest, RefusesIdsOutOfRange)
{
  Vtu vtu;
  vtu.connectivity = "0 1 2 4";
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("names point 4 where there are 4 points"));
  vtu.connectivity = "0 1 2 -1";
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("names point -1"));
  vtu = Vtu();
  vtu.cellData = Array("FaceNeighbors", "Int64", 4, "-1 -1 1 -1");
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("FaceNeighbors"));
  vtu.offsets = "400";
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("m.vtu: "));
}

TEST_F(MeshIOTest, RefusesNumbersThatCannotBe)
{
  const auto withCellData = [](const std::string & data) {
    Vtu vtu;
    vtu.cellData = data;
    return vtu.Text();
  };
  EXPECT_THAT(ErrorOfReading(withCellData(Array("DensityCoefficients", "Float64", 5, "1 2 3 4 5"))),
              HasSubstr("'DensityCoefficients' has 5 components where one of 1, 4, 10, 20"));
  EXPECT_THAT(
    ErrorOfReading(withCellData(Array("DensityCoefficients", "Float64", 1, "1") + Array("Degree", "Int32", 1, "1"))),
    HasSubstr("'Degree' has the value 1"));
  EXPECT_THAT(ErrorOfReading(withCellData(Array("Region", "Float64", 1, "1.5"))), HasSubstr("'Region'"));
  EXPECT_THAT(ErrorOfReading(withCellData(Array("Region", "Int32", 2, "1 1"))),
              HasSubstr("'Region' has 2 components where 1"));
  EXPECT_THAT(ErrorOfReading(withCellData(Array("FaceNeighbors", "Int64", 3, "-1 -1 -1"))),
              HasSubstr("'FaceNeighbors' has 3 components where 4"));
  EXPECT_THAT(ErrorOfReading(withCellData(Array("Region", "String", 1, "72 0"))), HasSubstr("'Region' is not numeric"));
  Vtu vtu;
  vtu.fieldData = Array("DensityQuantity", "Int32", 1, "6");
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("'DensityQuantity' has the value 6"));
  vtu = Vtu();
  vtu.points = "0 0 0 1 0 0 0 nan 0 0 0 1";
  EXPECT_THAT(ErrorOfReading(vtu.Text()), HasSubstr("point 2 has a coordinate that is not finite"));
}

TEST_F(MeshIOTest, RefusesToWriteWhatIsInconsistent)
{
  const auto errorOfWriting = [&](const MeshArrays & mesh) {
    return ErrorOf([&] { WriteMeshArrays(mesh, Path("m.vtu")); });
  };
  auto mesh = DensityBox({ 2 });
  mesh.layer.pop_back();
  EXPECT_THAT(errorOfWriting(mesh), HasSubstr("'Layer' has 11 entries where 12"));
  mesh = DensityBox({ 2 });
  mesh.coefficients.pop_back();
  EXPECT_THAT(errorOfWriting(mesh), HasSubstr("120 coefficients"));
  mesh = DensityBox({ 2 });
  mesh.coefficients[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(errorOfWriting(mesh), HasSubstr("a coefficient is not finite"));
  mesh = DensityBox({ 2 });
  mesh.points[7].x() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(errorOfWriting(mesh), HasSubstr("point 7 has a coordinate that is not finite"));
  mesh = DensityBox({ 2 });
  mesh.degree[3] = 4;
  EXPECT_THAT(errorOfWriting(mesh), HasSubstr("degree 4"));
  mesh = DensityBox({ 2 });
  mesh.tetrahedra[0][0] = 12;
  EXPECT_THAT(errorOfWriting(mesh), HasSubstr("names point 12"));
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(MeshIOTest, AWriteThatFailsLeavesNothing)
{
  const auto mesh = DensityBox({ 8 });
  EXPECT_THAT(ErrorOf([&] { WriteMeshArrays(mesh, Path("no/m.vtu")); }), HasSubstr("there is no folder"));
  EXPECT_THAT(ErrorOf([&] { WriteMeshArrays(mesh, Path("m.vtk")); }), HasSubstr("must end in .vtu"));
  EXPECT_THAT(ErrorOf([&] {
                const FullDisk full(4000);
                WriteMeshArrays(mesh, Path("m.vtu"));
              }),
              HasSubstr("m.vtu: cannot write"));
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(MeshIOTest, TheFileIsInlineBase64WithNumericArraysOnly)
{
  WriteMeshArrays(DensityBox({ 3 }), Path("m.vtu"));
  const std::string text = ReadText("m.vtu");
  EXPECT_THAT(text, testing::Not(HasSubstr("AppendedData")));
  EXPECT_THAT(text, testing::Not(HasSubstr("type=\"String\"")));
  EXPECT_THAT(text, testing::Not(HasSubstr("format=\"ascii\"")));
  for (const char * name :
       { "Region", "Layer", "Slice", "Degree", "DensityCoefficients", "FaceNeighbors", "Density", "MeanDensity" })
  {
    EXPECT_THAT(text, HasSubstr("Name=\"" + std::string(name) + "\""));
  }
}

// A tetrahedron's surface as ASCII PLY, some faces left out or turned.
std::string
Ply(const std::vector<std::string> & faces)
{
  std::string text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
                     "z\nelement face " +
                     std::to_string(faces.size()) +
                     "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  for (const auto & face : faces)
  {
    text += face + "\n";
  }
  return text;
}

using SurfaceIOTest = FileTest;

TEST_F(SurfaceIOTest, ReadsAClosedSurfaceAndTurnsItOutward)
{
  const auto volume = [&](const std::string & text) {
    WriteText("s.ply", text);
    const auto surface = ReadTriangleSurface(Path("s.ply"));
    double     sum = 0;
    for (const auto & t : surface.triangles)
    {
      sum += surface.points[t[0]].dot(surface.points[t[1]].cross(surface.points[t[2]])) / 6;
    }
    return sum;
  };
  EXPECT_NEAR(volume(Ply({ "3 0 2 1", "3 0 1 3", "3 1 2 3", "3 0 3 2" })), 1.0 / 6, 1e-12);
  EXPECT_NEAR(volume(Ply({ "3 0 1 2", "3 0 3 1", "3 1 3 2", "3 0 2 3" })), 1.0 / 6, 1e-12);
}

TEST_F(SurfaceIOTest, ReadsStl)
{
  std::string  text = "solid s\n";
  const char * corner[4] = { "0 0 0", "1 0 0", "0 1 0", "0 0 1" };
  for (const auto & f : { std::array<int, 3>{ 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 }, { 0, 3, 2 } })
  {
    text += "facet normal 0 0 0\nouter loop\n";
    for (int v : f)
    {
      text += std::string("vertex ") + corner[v] + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  WriteText("s.stl", text + "endsolid s\n");
  const auto surface = ReadTriangleSurface(Path("s.stl"));
  EXPECT_EQ(surface.points.size(), 4u);
  EXPECT_EQ(surface.triangles.size(), 4u);
}

TEST_F(SurfaceIOTest, RefusesOpenAndBrokenSurfaces)
{
  const auto error = [&](const std::string & name, const std::string & text) {
    WriteText(name, text);
    return ErrorOf([&] { ReadTriangleSurface(Path(name)); });
  };
  EXPECT_THAT(error("s.ply", Ply({ "3 0 2 1", "3 0 1 3", "3 1 2 3" })), HasSubstr("not closed: 3 edges"));
  EXPECT_THAT(error("s.ply", Ply({ "3 0 2 1", "3 0 1 3", "3 1 2 3", "3 0 2 3" })), HasSubstr("no manifold"));
  EXPECT_THAT(error("s.ply", Ply({ "3 0 2 1", "3 0 1 9", "3 1 2 3", "3 0 3 2" })), HasSubstr("s.ply: "));
  EXPECT_THAT(error("s.ply", Ply({})), HasSubstr("s.ply: "));
  EXPECT_THAT(error("s.ply", "This is a text."), HasSubstr("s.ply: "));
  EXPECT_THAT(error("s.stl", "This is a text."), HasSubstr("s.stl: "));
  EXPECT_THAT(error("s.vtp", "This is a text."), HasSubstr("is no readable VTK poly data"));
  EXPECT_THAT(error("s.stl", std::string(80, ' ') + std::string("\x01\x00\x00\x48", 4) + std::string(50, '\0')),
              HasSubstr("says that it has 1207959553 triangles"));
  EXPECT_THAT(error("s.obj", "v 0 0 0"), HasSubstr("must end in .ply or .vtp or .stl"));
  EXPECT_THAT(ErrorOf([&] { ReadTriangleSurface(Path("no.ply")); }), HasSubstr("there is no such file"));
}

// A tetrahedron's, its coordinates no short decimals.
TriangleSurface
SmallSurface()
{
  TriangleSurface surface;
  surface.points = { { 0.1, 0.2, 0.3 }, { 1.0 / 3.0, 0.2, 0.3 }, { 0.1, 1e-9 + 2.0, 0.3 }, { 0.1, 0.2, 5e5 / 7.0 } };
  surface.triangles = { { 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 }, { 0, 3, 2 } };
  return surface;
}

TEST_F(SurfaceIOTest, WritesWhatItReads)
{
  const TriangleSurface surface = SmallSurface();
  WriteTriangleSurface(surface, {}, Path("s.vtp"));
  EXPECT_EQ(ReadTriangleSurface(Path("s.vtp")), surface);
}

TEST_F(SurfaceIOTest, WritesPointDataOfWhichTheFirstAreActive)
{
  const std::vector<double> thickness{ 1.5, 2.5, 3.5, std::numeric_limits<double>::quiet_NaN() };
  WriteTriangleSurface(
    SmallSurface(), { { "thickness", thickness }, { "status", std::vector<int>{ 1, 1, 1, 0 } } }, Path("s.vtp"));
  const std::string text = ReadText("s.vtp");
  EXPECT_THAT(text, HasSubstr("<PointData Scalars=\"thickness\">"));
  EXPECT_THAT(text, HasSubstr("type=\"Float64\" Name=\"thickness\""));
  EXPECT_THAT(text, HasSubstr("RangeMin=\"1.5\""));
  EXPECT_THAT(text, HasSubstr("RangeMax=\"3.5\""));
  EXPECT_THAT(text, HasSubstr("type=\"Int32\" Name=\"status\""));
  EXPECT_EQ(ReadTriangleSurface(Path("s.vtp")), SmallSurface());
}

TEST_F(SurfaceIOTest, RefusesAnArrayOfAnotherSizeAndLeavesTheFileAsItWas)
{
  const auto error = [&](const std::string & name, std::size_t count) {
    return ErrorOf([&] { WriteTriangleSurface(SmallSurface(), { { "t", std::vector<double>(count) } }, Path(name)); });
  };
  WriteText("s.vtp", "older");
  for (const std::size_t count : { 0u, 3u, 5u })
  {
    EXPECT_THAT(error("s.vtp", count),
                HasSubstr("s.vtp: the array 't' has " + std::to_string(count) + " values for 4 points"));
  }
  EXPECT_EQ(ReadText("s.vtp"), "older");
  EXPECT_THAT(error("s.ply", 4), HasSubstr("must end in .vtp"));
}

TEST(SurfaceIORealData, ReadsAFemur)
{
  const char * folder = std::getenv("BONETK_DATA");
  if (folder == nullptr)
  {
    GTEST_SKIP() << "BONETK_DATA is not set";
  }
  const auto surface = ReadTriangleSurface(std::string(folder) + "/femur_shapes/r_femur_01.ply");
  EXPECT_EQ(surface.points.size(), 18291u);
  EXPECT_EQ(surface.triangles.size(), 36578u);
}
} // namespace MeshIOTests
} // namespace bone
