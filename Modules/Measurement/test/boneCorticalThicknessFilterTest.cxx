/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorticalThicknessFilter.h"

#include "boneTestBodies.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

namespace bone
{
namespace CorticalThicknessFilterTests
{
using Image = itk::Image<float, 3>;
using Filter = CorticalThicknessFilter<>;
constexpr double Radius = 12.0, Length = 32.0; // mm, of a tube along z

double
Normal(double x)
{
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/** What the CT of the tube is made of. */
struct Tube
{
  double          thickness{ 1.0 };
  double          inPlane{ 0.45 }; ///< mm, standard deviation of the blur
  double          spacing{ 0.8 };
  double          inside{ 200.0 };
  double          cortical{ 1500.0 };
  Eigen::Matrix3d turn{ Eigen::Matrix3d::Identity() }; ///< of the tube and its image
};

MeshArrays
MeshOf(const Tube & tube)
{
  test::TubeShape shape;
  shape.radius = Radius;
  shape.around = 36;
  shape.slices = 17;
  shape.spacing = Length / 16.0;
  shape.rings = { 1, 1 };
  shape.jitter = 0.0;
  shape.bend = 0.0;
  shape.bumps = 0.0;
  MeshArrays mesh = test::MakeTube(shape);
  for (Vector3 & p : mesh.points)
  {
    p = tube.turn * p;
  }
  return mesh;
}

/** The tube goes on beyond the image's ends, as a bone that the image cuts. */
Image::Pointer
ImageOf(const Tube & tube)
{
  auto             image = Image::New();
  const auto       across = static_cast<itk::SizeValueType>(2.0 * (Radius + 5.0) / tube.spacing);
  Image::SizeType  size{ { across, across, static_cast<itk::SizeValueType>(Length / tube.spacing) } };
  Image::IndexType start{ { 3, -2, 1 } };
  const double     low = -0.5 * (static_cast<double>(across) - 1.0) * tube.spacing;
  const Vector3    first = tube.turn * (Vector3(low, low, 0.2) - tube.spacing * Vector3(3, -2, 1));
  image->SetRegions(Image::RegionType(start, size));
  image->SetSpacing(itk::Vector<double, 3>(tube.spacing));
  Image::PointType     origin;
  Image::DirectionType direction;
  for (int i = 0; i < 3; ++i)
  {
    origin[i] = first[i];
    for (int j = 0; j < 3; ++j)
    {
      direction(i, j) = tube.turn(i, j);
    }
  }
  image->SetOrigin(origin);
  image->SetDirection(direction);
  image->Allocate();
  const double inner = Radius - tube.thickness;
  for (itk::SizeValueType k = 0; k < size[2]; ++k)
  {
    for (itk::SizeValueType j = 0; j < size[1]; ++j)
    {
      for (itk::SizeValueType i = 0; i < size[0]; ++i)
      {
        const double r = std::hypot(low + tube.spacing * i, low + tube.spacing * j);
        const double value = 40.0 + (tube.cortical - 40.0) * Normal((Radius - r) / tube.inPlane) +
                             (tube.inside - tube.cortical) * Normal((inner - r) / tube.inPlane);
        image->SetPixel({ { start[0] + static_cast<itk::IndexValueType>(i),
                            start[1] + static_cast<itk::IndexValueType>(j),
                            start[2] + static_cast<itk::IndexValueType>(k) } },
                        static_cast<float>(value));
      }
    }
  }
  return image;
}

Filter::Pointer
FilterOf(const Tube & tube)
{
  auto mesh = DensityMesh<double>::New();
  mesh->SetArrays(MeshOf(tube));
  auto filter = Filter::New();
  filter->SetMesh(mesh);
  filter->SetImage(ImageOf(tube));
  return filter;
}

/** Points of the side, away from the ends. */
std::vector<std::size_t>
SideOf(const CorticalThicknessMap & map, const Tube & tube)
{
  std::vector<std::size_t> side;
  for (std::size_t p = 0; p < map.surface.points.size(); ++p)
  {
    const Vector3 x = tube.turn.transpose() * map.surface.points[p];
    if (x.z() > 4.0 && x.z() < Length - 4.0 && std::hypot(x.x(), x.y()) > Radius - 1.0)
    {
      side.push_back(p);
    }
  }
  return side;
}

std::string
MessageOf(Filter * filter)
{
  try
  {
    filter->Update();
  }
  catch (const itk::ExceptionObject & error)
  {
    return error.GetDescription();
  }
  return {};
}

TEST(CorticalThicknessFilter, MeasuresTubesOfKnownBlurAndDensity)
{
  for (const double thickness : { 0.3, 0.6, 1.0, 2.0, 4.0 })
  {
    Tube tube;
    tube.thickness = thickness;
    const auto filter = FilterOf(tube);
    filter->SetPointSpread(2.35482 * tube.inPlane);
    filter->SetCorticalDensity(tube.cortical);
    filter->Update();
    const auto & map = filter->GetMap();
    const auto   side = SideOf(map, tube);
    ASSERT_GT(side.size(), 300u);
    for (const std::size_t p : side)
    {
      ASSERT_EQ(map.status[p], CorticalStatus::Found) << thickness;
      EXPECT_NEAR(map.thickness[p], thickness, 0.04);
      EXPECT_NEAR(map.density[p], tube.cortical, thickness > 2.5 ? 5.0 : 0.0);
    }
  }
}

TEST(CorticalThicknessFilter, FindsBlurAndDensityWhereTheCortexIsThick)
{
  Tube tube;
  tube.thickness = 4.0;
  const auto filter = FilterOf(tube);
  filter->Update();
  const auto & map = filter->GetMap();
  EXPECT_NEAR(map.corticalDensity, tube.cortical, 5.0);
  EXPECT_NEAR(map.blur.inPlane, tube.inPlane, 0.03);
  EXPECT_GT(map.thickPoints, 300u);
  for (const std::size_t p : SideOf(map, tube))
  {
    EXPECT_NEAR(map.thickness[p], tube.thickness, 0.04);
  }
}

TEST(CorticalThicknessFilter, IsTheSameHoweverTubeAndImageAreTurned)
{
  Tube straight, turned;
  turned.turn = Eigen::AngleAxisd(0.9, Vector3(1, 2, -1).normalized()).toRotationMatrix();
  for (const Tube & tube : { straight, turned })
  {
    const auto filter = FilterOf(tube);
    filter->SetPointSpread(2.35482 * tube.inPlane);
    filter->SetCorticalDensity(tube.cortical);
    filter->Update();
    const auto & map = filter->GetMap();
    EXPECT_NEAR(map.blur.axis.dot(tube.turn.col(2)), 1.0, 1e-9);
    for (const std::size_t p : SideOf(map, tube))
    {
      EXPECT_NEAR(map.thickness[p], tube.thickness, 0.04);
    }
  }
}

TEST(CorticalThicknessFilter, CutsHaveNoThickness)
{
  const Tube tube;
  const auto filter = FilterOf(tube);
  filter->SetPointSpread(1.0);
  filter->SetCorticalDensity(tube.cortical);
  filter->Update();
  const auto & map = filter->GetMap();
  int          middles = 0;
  for (std::size_t p = 0; p < map.status.size(); ++p)
  {
    const Vector3 & x = map.surface.points[p];
    EXPECT_EQ(std::isfinite(map.thickness[p]), map.status[p] == CorticalStatus::Found);
    EXPECT_EQ(std::isfinite(map.density[p]), map.status[p] == CorticalStatus::Found);
    if (std::hypot(x.x(), x.y()) < 1.0)
    {
      ++middles;
      EXPECT_NE(map.status[p], CorticalStatus::Found);
    }
  }
  EXPECT_EQ(middles, 2);
}

TEST(CorticalThicknessFilter, OutliersTakeTheMedianOfTheirNeighbours)
{
  Tube tube;
  tube.thickness = 4.0;
  const auto filter = FilterOf(tube);
  filter->SetRadius(1.2);
  filter->Update();
  EXPECT_EQ(filter->GetMap().outliers, 0u);
  // A pore in the cortex at one point of the side.
  const auto    clean = filter->GetMap();
  const auto    side = SideOf(clean, tube);
  const Vector3 pore = clean.surface.points[side[side.size() / 2]] * (1.0 - 2.0 / Radius);
  auto *        image = const_cast<Image *>(filter->GetImage());
  for (itk::SizeValueType v = 0; v < image->GetBufferedRegion().GetNumberOfPixels(); ++v)
  {
    Image::PointType x;
    image->TransformIndexToPhysicalPoint(image->ComputeIndex(static_cast<itk::OffsetValueType>(v)), x);
    const double apart =
      std::hypot(x[0] - pore[0], x[1] - pore[1], x[2] - clean.surface.points[side[side.size() / 2]][2]);
    if (apart < 2.0)
    {
      image->GetBufferPointer()[v] = 200.0f;
    }
  }
  image->Modified();
  filter->SetSmoothingSteps(0);
  filter->Update();
  const double raw = filter->GetMap().thickness[side[side.size() / 2]];
  EXPECT_EQ(filter->GetMap().outliers, 0u);
  EXPECT_GT(std::abs(raw - 4.0), 1.0);
  filter->SetSmoothingSteps(1);
  filter->Update();
  EXPECT_GE(filter->GetMap().outliers, 1u);
  EXPECT_NEAR(filter->GetMap().thickness[side[side.size() / 2]], 4.0, 0.3);
}

TEST(CorticalThicknessFilter, ThinCortexAloneDoesNotTellBlurAndDensity)
{
  const Tube tube;
  const auto filter = FilterOf(tube);
  EXPECT_NE(MessageOf(filter).find("give PointSpread"), std::string::npos) << MessageOf(filter);
  filter->SetPointSpread(1.0);
  EXPECT_NE(MessageOf(filter).find("give CorticalDensity"), std::string::npos) << MessageOf(filter);
  filter->SetCorticalDensity(1500.0);
  EXPECT_EQ(MessageOf(filter), "");
}

TEST(CorticalThicknessFilter, RefusesWhatItCannotMeasure)
{
  const auto filter = Filter::New();
  EXPECT_NE(MessageOf(filter).find("Image"), std::string::npos) << MessageOf(filter);
  filter->SetImage(ImageOf(Tube()));
  EXPECT_NE(MessageOf(filter).find("Mesh"), std::string::npos) << MessageOf(filter);
  const auto whole = FilterOf(Tube());
  whole->SetDepth(-1.0);
  EXPECT_NE(MessageOf(whole).find("Depth is -1 mm"), std::string::npos) << MessageOf(whole);
  whole->SetDepth(10.0);
  auto * image = const_cast<Image *>(whole->GetImage());
  auto   origin = image->GetOrigin();
  origin[0] += 1000.0;
  image->SetOrigin(origin);
  EXPECT_NE(MessageOf(whole).find("The mesh lies outside the image"), std::string::npos) << MessageOf(whole);
  origin[0] -= 1000.0;
  image->SetOrigin(origin);
  image->FillBuffer(std::nanf(""));
  EXPECT_NE(MessageOf(whole).find("not finite"), std::string::npos) << MessageOf(whole);
  auto empty = DensityMesh<double>::New();
  whole->SetMesh(empty);
  EXPECT_NE(MessageOf(whole).find("no tetrahedra"), std::string::npos) << MessageOf(whole);
}

TEST(CorticalThicknessReport, CountsPointsWithTheirArea)
{
  CorticalThicknessMap map;
  // A tetrahedron of three right corners: the areas of its points are 1/6 of 3 (at the corner) or of 2 + sqrt(3).
  map.surface.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  map.surface.triangles = { { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 } };
  map.thickness = { 1.0, 2.0, 3.0, std::nan("") };
  map.density.assign(4, 1500.0);
  map.status = { CorticalStatus::Found, CorticalStatus::Found, CorticalStatus::Found, CorticalStatus::Solid };
  const auto   report = ReportThickness(map);
  const double corner = 3.0 / 6.0, other = (2.0 + std::sqrt(3.0)) / 6.0, area = corner + 3.0 * other;
  EXPECT_NEAR(report["thickness"]["mean"].get<double>(), (corner + 5.0 * other) / (corner + 2.0 * other), 1e-12);
  EXPECT_EQ(report["thickness"]["median"], 2.0);
  EXPECT_EQ(report["thickness"]["percentile5"], 1.0);
  EXPECT_EQ(report["thickness"]["percentile95"], 3.0);
  EXPECT_NEAR(report["shareOfArea"]["solid"].get<double>(), other / area, 1e-12);
  EXPECT_EQ(report["points"], 4);
}
} // namespace CorticalThicknessFilterTests
} // namespace bone
