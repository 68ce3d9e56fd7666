/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasRegistrationFilter.h"
#include "boneFacetFit.h"
#include "boneInteriorDeformation.h"
#include "boneSurfaceDeformation.h"

#include "boneAtlasTestPopulation.h"
#include "boneQualityMeasures.h"

#include <itkMultiThreaderBase.h>

#include <gtest/gtest.h>

namespace AtlasRegistrationFilterTests
{
using namespace bone;
using namespace bone::test;

/** A curved, layered body without symmetry. */
MeshArrays
Standard()
{
  TubeShape shape;
  shape.slices = 14;
  shape.around = 12;
  shape.spacing = 3;
  shape.rings = { 1, 1 };
  shape.bend = 8;
  shape.jitter = 0.1;
  MeshArrays mesh = MakeTube(shape);
  for (Vector3 & x : mesh.points)
  {
    x.head<2>() *= 1 + 0.012 * x[2];
    x[1] *= 0.8 + 0.01 * x[0];
  }
  return mesh;
}

void
Bend(std::vector<Vector3> & points, double amount)
{
  for (Vector3 & x : points)
  {
    x[1] += amount * 0.004 * x[2] * x[2];
    x[2] *= 1 + 0.1 * amount;
    x[0] *= 1 - 0.05 * amount;
  }
}

DensityMesh<double>::Pointer
ToMesh(const MeshArrays & arrays)
{
  auto mesh = DensityMesh<double>::New();
  mesh->SetArrays(arrays);
  return mesh;
}

AtlasRegistrationFilter<>::Pointer
Filter(const MeshArrays & standard, const MeshArrays & subject)
{
  auto filter = AtlasRegistrationFilter<>::New();
  filter->SetStandard(ToMesh(standard));
  filter->SetSubject(ToMesh(subject));
  return filter;
}

double
MeanDistance(const std::vector<Vector3> & a, const std::vector<Vector3> & b)
{
  double sum = 0;
  for (std::size_t p = 0; p < a.size(); ++p)
  {
    sum += (a[p] - b[p]).norm() / static_cast<double>(a.size());
  }
  return sum;
}

TEST(AtlasRegistrationFilter, FindsTheStandardItselfInAnyPose)
{
  const MeshArrays standard = Standard();
  for (unsigned seed = 1; seed <= 2; ++seed)
  {
    MeshArrays subject = standard;
    Move(RandomPose(seed), subject.points);
    const auto filter = Filter(standard, subject);
    filter->Update();
    EXPECT_LT(MeanDistance(filter->GetOutput()->GetArrays().points, subject.points), 0.05) << seed;
    EXPECT_LT(filter->GetReport().surfaceDistance, 0.02);
    EXPECT_EQ(CountInverted(filter->GetOutput()->GetArrays()), 0u);
  }
}

TEST(AtlasRegistrationFilter, FollowsADeformation)
{
  const MeshArrays standard = Standard();
  MeshArrays       subject = standard;
  Bend(subject.points, 1.0);
  const AffineMap pose = RandomPose(5);
  Move(pose, subject.points);
  for (const auto rule : { InteriorRule::Harmonic, InteriorRule::EigenFrame })
  {
    const auto filter = Filter(standard, subject);
    filter->SetInterior(rule);
    filter->Update();
    EXPECT_LT(filter->GetReport().surfaceDistance, 0.25);
    std::vector<Vector3> aligned = standard.points;
    Move(filter->GetReport().alignment, aligned);
    const double error = MeanDistance(filter->GetOutput()->GetArrays().points, subject.points);
    EXPECT_LT(error, 1.5); // the cells are 4 mm wide
    EXPECT_LT(error, MeanDistance(aligned, subject.points));
    EXPECT_EQ(CountInverted(filter->GetOutput()->GetArrays()), 0u);
    EXPECT_EQ(filter->GetOutput()->GetTetrahedra(), standard.tetrahedra);
    EXPECT_EQ(filter->GetOutput()->GetCells().region, standard.region);
  }
}

TEST(AtlasRegistrationFilter, NonRigidICPFollowsToo)
{
  const MeshArrays standard = Standard();
  MeshArrays       subject = standard;
  Bend(subject.points, 0.7);
  const auto filter = Filter(standard, subject);
  filter->SetMethod(DeformationMethod::NonRigidICP);
  filter->Update();
  EXPECT_LT(filter->GetReport().surfaceDistance, 0.3);
  EXPECT_LT(MeanDistance(filter->GetOutput()->GetArrays().points, subject.points), 1.0);
}

TEST(AtlasRegistrationFilter, MirroredSubjects)
{
  const MeshArrays standard = Standard();
  MeshArrays       subject = standard;
  subject.points = ReflectPoints(subject.points);
  MakePositive(subject);
  const AffineMap pose = RandomPose(8);
  Move(pose, subject.points);
  const auto filter = Filter(standard, subject);
  filter->SetMirror(MirrorMode::Try);
  filter->Update();
  EXPECT_TRUE(filter->GetReport().mirrored);
  EXPECT_LT(MeanDistance(ReflectPoints(filter->GetOutput()->GetArrays().points), subject.points), 0.1);
  const auto same = Filter(standard, standard);
  same->SetMirror(MirrorMode::Try);
  same->Update();
  EXPECT_FALSE(same->GetReport().mirrored);
}

TEST(AtlasRegistrationFilter, SurfaceOrMeshIsTheSameSubject)
{
  const MeshArrays standard = Standard();
  MeshArrays       subject = standard;
  Bend(subject.points, 0.5);
  const auto mesh = Filter(standard, subject);
  mesh->FitLayersOff();
  mesh->Update();
  std::vector<IdType> id;
  auto                surface = AtlasRegistrationFilter<>::New();
  surface->SetStandard(ToMesh(standard));
  surface->SetSubjectSurface(ExteriorSurface(subject, id));
  surface->Update();
  EXPECT_EQ(mesh->GetOutput()->GetArrays().points, surface->GetOutput()->GetArrays().points);
  const auto before = surface->GetOutput()->GetMTime();
  surface->SetSubjectSurface(ExteriorSurface(subject, id));
  surface->Update();
  EXPECT_EQ(surface->GetOutput()->GetMTime(), before);
}

/** Moves the surface between layers outward, by more than half of the outer layer's thickness at most. */
MeshArrays
WithThinnerLayer(MeshArrays mesh)
{
  std::vector<IdType>   exteriorId, innerId;
  const TriangleSurface exterior = ExteriorSurface(mesh, exteriorId), inner = ExteriorSurface(mesh, innerId, 2);
  const auto            normals = PointNormals(inner);
  for (std::size_t i = 0; i < innerId.size(); ++i)
  {
    if (!std::binary_search(exteriorId.begin(), exteriorId.end(), innerId[i]))
    {
      mesh.points[innerId[i]] += 1.0 * normals[i];
    }
  }
  return mesh;
}

TEST(AtlasRegistrationFilter, SurfacesBetweenLayersAreLaidOnTheSubjects)
{
  const MeshArrays standard = Standard();
  MeshArrays       subject = WithThinnerLayer(standard);
  ASSERT_EQ(CountInverted(subject), 0u);
  Bend(subject.points, 0.5);
  Move(RandomPose(4), subject.points);
  std::vector<IdType> id;
  const double        volume = EnclosedVolume(ExteriorSurface(subject, id, 2));
  double              error[2];
  for (const bool fit : { false, true })
  {
    const auto filter = Filter(standard, subject);
    filter->SetFitLayers(fit);
    filter->Update();
    const MeshArrays & result = filter->GetOutput()->GetArrays();
    EXPECT_EQ(CountInverted(result), 0u);
    EXPECT_EQ(filter->GetReport().layerDistance.size(), fit ? 1u : 0u);
    error[fit] = std::abs(EnclosedVolume(ExteriorSurface(result, id, 2)) / volume - 1.0);
    if (fit)
    {
      EXPECT_LT(filter->GetReport().layerDistance[0], 0.2);
    }
  }
  EXPECT_GT(error[0], 0.1); // there is something to be laid
  EXPECT_LT(error[1], 0.03);
}

TEST(AtlasRegistrationFilter, LayersOfAMirroredSubject)
{
  const MeshArrays    standard = Standard();
  MeshArrays          subject = WithThinnerLayer(standard);
  std::vector<IdType> id;
  const double        volume = EnclosedVolume(ExteriorSurface(subject, id, 2));
  subject.points = ReflectPoints(subject.points);
  MakePositive(subject);
  const auto filter = Filter(standard, subject);
  filter->SetMirror(MirrorMode::Try);
  filter->Update();
  EXPECT_TRUE(filter->GetReport().mirrored);
  EXPECT_NEAR(EnclosedVolume(ExteriorSurface(filter->GetOutput()->GetArrays(), id, 2)) / volume, 1.0, 0.03);
}

TEST(AtlasRegistrationFilter, IsTheSameForAnyNumberOfThreads)
{
  const MeshArrays standard = Standard();
  MeshArrays       subject = standard;
  Bend(subject.points, 0.5);
  const auto before = itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads();
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  const auto one = Filter(standard, subject);
  one->Update();
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(3);
  const auto three = Filter(standard, subject);
  three->Update();
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(before);
  EXPECT_EQ(one->GetOutput()->GetArrays().points, three->GetOutput()->GetArrays().points);
}

TEST(AtlasRegistrationFilter, RefusesBadInput)
{
  const MeshArrays standard = Standard();
  auto             filter = AtlasRegistrationFilter<>::New();
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetStandard(ToMesh(standard));
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  MeshArrays inverted = standard;
  std::swap(inverted.tetrahedra[3][0], inverted.tetrahedra[3][1]);
  inverted.neighbors.clear();
  EXPECT_THROW(Filter(inverted, standard)->Update(), itk::ExceptionObject);
  auto none = Filter(standard, standard);
  none->SetAlignment(AlignmentKind::None);
  EXPECT_THROW(none->Update(), itk::ExceptionObject);
}

TEST(UntangleMesh, PutsAnInvertedCellRightAndLeavesTheRest)
{
  const MeshArrays    standard = Standard();
  std::vector<IdType> exterior;
  ExteriorSurface(standard, exterior);
  std::vector<char> outside(standard.points.size(), 0);
  for (const IdType p : exterior)
  {
    outside[p] = 1;
  }
  IdType inner = 0;
  while (outside[inner] != 0)
  {
    ++inner;
  }
  std::vector<Vector3> points = standard.points;
  points[inner] += Vector3(6, 5, 0);
  MeshArrays tangled = standard;
  tangled.points = points;
  const std::size_t before = CountInverted(tangled);
  ASSERT_GT(before, 0u);
  const auto report = UntangleMesh(standard, exterior, AffineMap(), points);
  EXPECT_EQ(report.before, before);
  EXPECT_EQ(report.after, 0u);
  EXPECT_LE(report.exterior, 0.5 + 1e-12);
  tangled.points = points;
  EXPECT_EQ(CountInverted(tangled), 0u);
  std::vector<Vector3> valid = standard.points;
  EXPECT_EQ(UntangleMesh(standard, exterior, AffineMap(), valid).moved, 0u);
  EXPECT_EQ(valid, standard.points);
}

TEST(InteriorDeformation, AffineMapsAreReproduced)
{
  const MeshArrays    standard = Standard();
  std::vector<IdType> exterior;
  ExteriorSurface(standard, exterior);
  AffineMap map = RandomPose(4);
  map.linear *= 1.2;
  std::vector<Vector3> moved, expected = standard.points;
  Move(map, expected);
  for (const IdType p : exterior)
  {
    moved.push_back(expected[p]);
  }
  const InteriorDeformation interior(standard, exterior);
  EXPECT_LT(MeanDistance(interior.Deform(InteriorRule::Harmonic, map, moved), expected), 1e-9);
  // A linear displacement is harmonic: another alignment gives the same.
  EXPECT_LT(MeanDistance(interior.Deform(InteriorRule::Harmonic, AffineMap(), moved), expected), 1e-9);
  const AffineMap      rigid = RandomPose(4);
  std::vector<Vector3> turned = standard.points;
  Move(rigid, turned);
  for (std::size_t i = 0; i < exterior.size(); ++i)
  {
    moved[i] = turned[exterior[i]];
  }
  EXPECT_LT(MeanDistance(interior.Deform(InteriorRule::EigenFrame, rigid, moved), turned), 1e-9);
}

TEST(DeformAdaptiveFocus, ProminentVerticesComeFirstWhereThereIsFocus)
{
  std::vector<IdType> id;
  TriangleSurface     source = ExteriorSurface(MakeBall(4, { 1, 1 }, 10.0, 0.0, 1), id);
  TriangleSurface     target = source;
  for (std::size_t v = 0; v < source.points.size(); ++v)
  {
    Vector3 &x = source.points[v], &y = target.points[v];
    x[2] *= 3;
    y = x;
    y[0] += std::max(0.0, x[2] - 15) * 0.4; // bent near one tip: no affine map
  }
  const DirectedSurface   directed(target);
  AdaptiveFocusParameters parameters;
  parameters.rings = { 16 };
  parameters.iterations = 1;
  const auto tipDistance = [&](double focus) {
    parameters.focus = focus;
    const auto points = DeformAdaptiveFocus(source, directed, parameters);
    double     sum = 0;
    for (std::size_t v = 0; v < points.size(); ++v)
    {
      sum += source.points[v][2] > 27 ? (points[v] - target.points[v]).norm() : 0.0;
    }
    return sum;
  };
  EXPECT_LT(tipDistance(2.0), 0.9 * tipDistance(0.0));
}

TEST(AttributeVectors, AreUnchangedByAffineMaps)
{
  std::vector<IdType>   id;
  const TriangleSurface surface = ExteriorSurface(Standard(), id);
  const RingNeighbors   rings = FindRings(surface, 4);
  AffineMap             map = RandomPose(2);
  map.linear *= Vector3(1.5, 0.7, 1.1).asDiagonal();
  std::vector<Vector3> moved = surface.points;
  Move(map, moved);
  const Eigen::MatrixXd difference = AttributeVectors(surface.points, rings, 4) - AttributeVectors(moved, rings, 4);
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-9);
}

TEST(FitFacets, GivesACoarseBallTheVolumeOfAFineOne)
{
  std::vector<IdType>   id;
  const TriangleSurface fine = ExteriorSurface(MakeBall(8, { 1, 1 }, 20.0, 0.0, 1), id);
  TriangleSurface       coarse = ExteriorSurface(MakeBall(2, { 1, 1 }, 20.0, 0.0, 1), id);
  const DirectedSurface target(fine);
  const double          volume = EnclosedVolume(fine);
  const TriangleSurface before = coarse;
  FitFacets(coarse, target, { {}, 5.0 });
  EXPECT_EQ(coarse.points, before.points);
  const double lack = volume - EnclosedVolume(coarse);
  ASSERT_GT(lack, 0.05 * volume);
  FitFacets(coarse, target, { { 0, 0 }, 5.0 });
  EXPECT_LT(std::abs(volume - EnclosedVolume(coarse)), 0.1 * lack);

  TriangleSurface bounded = before;
  FitFacets(bounded, target, { { 0, 0 }, 0.25 });
  for (std::size_t v = 0; v < bounded.points.size(); ++v)
  {
    EXPECT_LE((bounded.points[v] - before.points[v]).norm(), 0.25 + 1e-12);
  }
}

TEST(FitFacets, LeavesASurfaceThatLiesOnTheTarget)
{
  std::vector<IdType>   id;
  TriangleSurface       surface = ExteriorSurface(Standard(), id);
  const auto            points = surface.points;
  const DirectedSurface target(surface);
  FitFacets(surface, target, { { 0, 0, 0 }, 0.5 });
  EXPECT_LT(MeanDistance(surface.points, points),
            0.005); // none but at the sharp edges of the ends, where normals differ
}
} // namespace AtlasRegistrationFilterTests
