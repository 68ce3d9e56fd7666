/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHierarchyIO.h"

#include "boneTestFiles.h"
#include "boneTestMeshes.h"

namespace bone
{
using testing::ElementsAre;
using testing::HasSubstr;

namespace HierarchyIOTests
{
// The box, and its first cube as the coarser level.
DensityHierarchy<>::Pointer
TwoLevels()
{
  std::vector<DensityHierarchy<>::Level> levels(2);
  auto                                   mesh = DensityBox({ 2 });
  levels[0].mesh = DensityMesh<double>::New();
  levels[0].mesh->SetArrays(mesh);
  mesh.tetrahedra.resize(6);
  mesh.region.resize(6);
  mesh.degree.resize(6);
  mesh.coefficients.resize(60);
  mesh.neighbors.clear();
  levels[1].parentPoint = RemoveUnusedPoints(mesh);
  levels[1].mesh = DensityMesh<double>::New();
  levels[1].mesh->SetArrays(mesh);
  levels[1].densityErrorBound = 12.5;
  levels[1].densityError = 1.0 / 3;
  levels[1].surfaceError = 0.1;
  levels[1].stopReason = "tetrahedra reached";
  auto hierarchy = DensityHierarchy<>::New();
  hierarchy->SetLevels(levels);
  return hierarchy;
}

using HierarchyIOTest = FileTest;

TEST_F(HierarchyIOTest, LevelsAreReadAsWritten)
{
  const auto hierarchy = TwoLevels();
  const auto paths = WriteHierarchy(hierarchy, Path("h.v2"));
  EXPECT_THAT(paths, ElementsAre(Path("h.v2_L1.vtu"), Path("h.v2_L2.vtu"), Path("h.v2.hierarchy.json")));
  EXPECT_THAT(Files(), ElementsAre("h.v2.hierarchy.json", "h.v2_L1.vtu", "h.v2_L2.vtu"));
  const auto back = ReadHierarchy(Path("h.v2.hierarchy.json"));
  ASSERT_EQ(back->GetNumberOfLevels(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
  {
    const auto & a = hierarchy->GetLevels()[i];
    const auto & b = back->GetLevels()[i];
    EXPECT_EQ(a.mesh->GetTetrahedra(), b.mesh->GetTetrahedra());
    EXPECT_EQ(a.mesh->GetArrays().points, b.mesh->GetArrays().points);
    EXPECT_EQ(a.parentPoint, b.parentPoint);
    EXPECT_EQ(a.densityErrorBound, b.densityErrorBound);
    EXPECT_EQ(a.densityError, b.densityError);
    EXPECT_EQ(a.surfaceError, b.surfaceError);
    EXPECT_EQ(a.stopReason, b.stopReason);
  }
}

TEST_F(HierarchyIOTest, SaysWhatIsWrong)
{
  WriteHierarchy(TwoLevels(), Path("h"));
  const std::string good = ReadText("h.hierarchy.json");
  const auto        error = [&](const std::string & from, const std::string & to) {
    std::string text = good;
    EXPECT_NE(text.rfind(from), std::string::npos) << from;
    WriteText("h.hierarchy.json", text.replace(text.rfind(from), from.size(), to));
    return ErrorOf([&] { ReadHierarchy(Path("h.hierarchy.json")); });
  };
  EXPECT_THAT(ErrorOf([&] { ReadHierarchy(Path("no.json")); }), HasSubstr("there is no such file"));
  EXPECT_THAT(error("\"levels\"", "\"lovels\""), HasSubstr("'levels' is missing"));
  EXPECT_THAT(error("h_L2.vtu", "h_L3.vtu"), HasSubstr("h.hierarchy.json: level 2: "));
  EXPECT_THAT(error("h_L2.vtu", "h_L3.vtu"), HasSubstr("h_L3.vtu: there is no such file"));
  EXPECT_THAT(error("h_L2.vtu", ""), HasSubstr("level 2: 'file' must be the name of a file"));
  EXPECT_THAT(error("\"points\": 8", "\"points\": 9"), HasSubstr("level 2: the file 'h_L2.vtu' has 8 points"));
  EXPECT_THAT(error("\"points\": 8", "\"points\": \"8\""), HasSubstr("'points' must be a whole number"));
  EXPECT_THAT(error("10\n", "12\n"), HasSubstr("'parentPoint' has an entry that is no id of the 12 points"));
  EXPECT_THAT(error(",\n    10\n", "\n"), HasSubstr("'parentPoint' must be a list of 8 ids"));
  EXPECT_THAT(error("\"stopReason\"", "\"stop\""), HasSubstr("'stopReason' is missing"));
}

TEST_F(HierarchyIOTest, AWriteThatFailsLeavesNothing)
{
  const auto hierarchy = TwoLevels();
  EXPECT_THAT(ErrorOf([&] { WriteHierarchy(hierarchy, Path("no/h")); }), HasSubstr("there is no folder"));
  EXPECT_THAT(ErrorOf([&] {
                const FullDisk full(3000);
                WriteHierarchy(hierarchy, Path("h"));
              }),
              HasSubstr("cannot write"));
  EXPECT_THAT(Files(), testing::IsEmpty());
}
} // namespace HierarchyIOTests
} // namespace bone
