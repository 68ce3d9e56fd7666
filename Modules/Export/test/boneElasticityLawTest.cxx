/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneElasticityLaw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ElasticityLawTests
{
using namespace bone;

TEST(ElasticityLaw, PublishedLawsHaveTheirPublishedValues)
{
  // E in MPa at a density in g/cm^3, worked out by hand.
  EXPECT_NEAR(FindElasticityLaw("morgan2003-neck")(0.5), 2438.7, 0.1);
  EXPECT_NEAR(FindElasticityLaw("morgan2003-vertebra")(0.2), 384.1, 0.1);
  EXPECT_NEAR(FindElasticityLaw("morgan2003-tibia")(0.25), 1069.0, 0.5);
  EXPECT_NEAR(FindElasticityLaw("morgan2003-trochanter")(0.2), 449.4, 0.1);
  EXPECT_NEAR(FindElasticityLaw("morgan2003-pooled")(1.0), 8920.0, 1e-9);
  EXPECT_NEAR(FindElasticityLaw("keller1994")(1.0), 10500.0, 1e-9);
  EXPECT_NEAR(FindElasticityLaw("keyak1998")(0.1), 213.9, 0.1);
  EXPECT_NEAR(FindElasticityLaw("keyak1998")(0.5), 3122.5, 1e-9);
  EXPECT_NEAR(FindElasticityLaw("keyak1998")(1.0), 10200.0, 1e-9);
  EXPECT_NEAR(FindElasticityLaw("carter1977")(1.0), 2875.0, 1.0);
  EXPECT_NEAR(FindElasticityLaw("snyder1991")(1.8), 15938.0, 1e-9);
}

TEST(ElasticityLaw, PiecesMeet)
{
  for (const ElasticityLaw & law : PublishedElasticityLaws())
  {
    for (std::size_t i = 1; i < law.pieces.size(); ++i)
    {
      const double at = law.pieces[i].from;
      EXPECT_NEAR(law(at) / law(at - 1e-9), 1.0, 2e-3) << law.name << " at " << at;
    }
  }
}

TEST(ElasticityLaw, IsNowhereBelowZeroAndSaysWhereItHolds)
{
  for (const ElasticityLaw & law : PublishedElasticityLaws())
  {
    EXPECT_EQ(law(-0.1), 0.0) << law.name;
    EXPECT_EQ(law(0.0), 0.0) << law.name;
    EXPECT_GE(law(0.01), 0.0) << law.name;
    EXPECT_LT(law.low, law.high) << law.name;
    EXPECT_GT(law(law.high), 0.0) << law.name;
    EXPECT_FALSE(law.source.empty() || law.bone.empty()) << law.name;
  }
}

TEST(ElasticityLaw, ItsRelationReadsAsItIs)
{
  EXPECT_EQ(FindElasticityLaw("keyak1998").DescribeRelation(),
            "E = 33900 rho^2.2, from 0.27 on 5307 rho + 469, from 0.6 on 10200 rho^2.01");
  EXPECT_EQ(FindElasticityLaw("snyder1991").DescribeRelation(), "E = 21910 rho - 23500");
}

TEST(ElasticityLaw, AnUnknownNameIsAnsweredWithTheNames)
{
  try
  {
    FindElasticityLaw("morgan");
    FAIL();
  }
  catch (const std::invalid_argument & error)
  {
    EXPECT_THAT(error.what(), testing::HasSubstr("'morgan'"));
    EXPECT_THAT(error.what(), testing::HasSubstr("morgan2003-neck, "));
  }
}
} // namespace ElasticityLawTests
