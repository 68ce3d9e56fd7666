/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include <Eigen/Eigenvalues> // in place of that of ITK's own, older Eigen
#include <itkEuler3DTransform.h>

#include "boneIOError.h"
#include "boneTransformIO.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace TransformIOTests
{
using Transform = itk::Euler3DTransform<double>;

class TransformIO : public ::testing::Test
{
protected:
  void
  SetUp() override
  {
    const auto * test = testing::UnitTest::GetInstance()->current_test_info(); // tests run side by side
    m_Folder = std::filesystem::path(testing::TempDir()) / (std::string("boneTransformIOTest.") + test->name());
    std::filesystem::remove_all(m_Folder);
    std::filesystem::create_directories(m_Folder);
  }
  void
  TearDown() override
  {
    std::filesystem::remove_all(m_Folder);
  }
  std::string
  Path(const std::string & name) const
  {
    return (m_Folder / name).string();
  }
  std::string
  Write(const std::string & name,
        const std::string & type,
        const std::string & parameters,
        const std::string & fixed) const
  {
    std::ofstream(Path(name)) << "#Insight Transform File V1.0\n#Transform 0\nTransform: " << type
                              << "\nParameters: " << parameters << "\nFixedParameters: " << fixed << "\n";
    return Path(name);
  }
  static std::string
  Refusal(const std::string & path)
  {
    try
    {
      bone::ReadRigidTransform(path);
    }
    catch (const bone::IOError & error)
    {
      return error.what();
    }
    return "";
  }

  std::filesystem::path m_Folder;
};

TEST_F(TransformIO, ReadsWhatItWrote)
{
  auto                   written = Transform::New();
  itk::Point<double, 3>  centre;
  itk::Vector<double, 3> shift;
  for (unsigned int i = 0; i < 3; ++i)
  {
    centre[i] = 10.0 + i;
    shift[i] = -3.5 * i;
  }
  written->SetCenter(centre);
  written->SetRotation(0.3, -0.2, 0.7);
  written->SetTranslation(shift);
  bone::WriteRigidTransform(*written, Path("a.tfm"));
  const auto read = bone::ReadRigidTransform(Path("a.tfm"));
  EXPECT_LT((read->TransformPoint(shift) - written->TransformPoint(shift)).GetNorm(), 1e-9);
  EXPECT_LT((read->GetCenter() - centre).GetNorm(), 1e-12);
}

TEST_F(TransformIO, TakesRigidTransformsOfOtherKinds)
{
  const auto read =
    bone::ReadRigidTransform(Write("slicer.tfm", "AffineTransform_double_3_3", "0 -1 0 1 0 0 0 0 1 5 6 7", "0 0 0"));
  const itk::Point<double, 3> x(1.0);
  EXPECT_NEAR(read->TransformPoint(x)[0], 4.0, 1e-9);
  EXPECT_NEAR(read->TransformPoint(x)[1], 7.0, 1e-9);
  EXPECT_NEAR(read->TransformPoint(x)[2], 8.0, 1e-9);
}

TEST_F(TransformIO, RefusesWhatIsNotRigid)
{
  using ::testing::HasSubstr;
  EXPECT_THAT(Refusal(Path("none.tfm")), HasSubstr("none.tfm"));
  EXPECT_THAT(Refusal(Write("scaled.tfm", "AffineTransform_double_3_3", "1 0 0 0 1 0 0 0 1.01 0 0 0", "0 0 0")),
              HasSubstr("no rotation"));
  EXPECT_THAT(Refusal(Write("mirror.tfm", "AffineTransform_double_3_3", "1 0 0 0 1 0 0 0 -1 0 0 0", "0 0 0")),
              HasSubstr("mirrors"));
  EXPECT_THAT(Refusal(Write("flat.tfm", "Euler2DTransform_double_2_2", "0.1 2 3", "0 0")),
              HasSubstr("three dimensions"));
  EXPECT_THAT(Refusal(Write("far.tfm", "Euler3DTransform_double_3_3", "0 0 0 1e300 0 0", "0 0 0 0")),
              HasSubstr("which no rigid transform of a bone has"));
  std::ofstream(Path("text.tfm")) << "hello\n";
  EXPECT_THAT(Refusal(Path("text.tfm")), HasSubstr("no ITK transform file"));
}

TEST_F(TransformIO, RefusesMissingAndWildNumbers)
{
  using ::testing::HasSubstr;
  const std::string euler = "Euler3DTransform_double_3_3";
  EXPECT_THAT(Refusal(Write("short.tfm", euler, "-0.01 0.03 0 0 0", "0 0 0 0")), HasSubstr("has 5 Parameters"));
  EXPECT_THAT(Refusal(Write("long.tfm", euler, "0 0 0 0 0 0 0", "0 0 0 0")), HasSubstr("has 7 Parameters"));
  EXPECT_THAT(Refusal(Write("centre.tfm", euler, "0 0 0 0 0 0", "0 0")), HasSubstr("has 2 FixedParameters"));
  EXPECT_THAT(Refusal(Write("nan.tfm", euler, "0 0 0 nan 0 0", "0 0 0 0")), HasSubstr("no number"));
  EXPECT_THAT(Refusal(Write("word.tfm", euler, "0 0 0 1x 0 0", "0 0 0 0")), HasSubstr("no number"));
  EXPECT_THAT(Refusal(Write("other.tfm", "NoSuchTransform_double_3_3", "0", "0")), HasSubstr("not known"));
  EXPECT_THAT(Refusal(Write("two.tfm", euler, "0 0 0 0 0 0\nTransform: " + euler, "0 0 0")), HasSubstr("2 transforms"));
  EXPECT_THAT(Refusal(Write("twice.tfm", euler, "0 0 0 0 0 0\nParameters: 1 0 0 0 0 0", "0 0 0")),
              HasSubstr("more than one line"));
}

TEST_F(TransformIO, TakesFilesOfOlderVersionsAndSinglePrecision)
{
  const auto read = bone::ReadRigidTransform(Write("old.tfm", "Euler3DTransform_float_3_3", "0 0 0 1 2 3", "4 5 6"));
  EXPECT_EQ(read->GetTranslation()[2], 3.0);
  EXPECT_EQ(read->GetCenter()[0], 4.0);
}
} // namespace TransformIOTests
