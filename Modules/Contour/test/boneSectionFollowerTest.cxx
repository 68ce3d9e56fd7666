/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionFollower.h"

#include "boneContourTestTools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bone
{
namespace SectionFollowerTests
{
using testing::HasSubstr;

constexpr double Pixel = 0.7;

// Slices of a density f(x, y, z) on 80 x 70 pixels, 1 mm apart.
class Follow
{
public:
  explicit Follow(std::function<double(double, double, double)> f, int count = 24)
    : m_F(std::move(f))
  {
    for (int k = 0; k < count; ++k)
    {
      sections.push_back({ static_cast<double>(k), {} });
    }
  }

  Follow &
  Draw(std::size_t slice, const Polygon & contour)
  {
    sections[slice].pieces.push_back({ contour, {}, {}, {} });
    return *this;
  }

  Follow &
  Run()
  {
    const PlaneSource planes = [this](double height, const Vector2 &, const Vector2 &) {
      PlaneField plane;
      plane.grid = { { { 80, 70 } }, { -28.0, -24.5 }, { Pixel, Pixel } };
      for (int j = 0; j < 70; ++j)
      {
        for (int i = 0; i < 80; ++i)
        {
          const Vector2 q = plane.grid.Node(i, j);
          plane.values.push_back(static_cast<float>(m_F(q.x(), q.y(), height)));
        }
      }
      return plane;
    };
    events = SectionFollower(planes, { Pixel, Pixel }, FollowParameters()).Follow(sections, 1.0, Execution());
    return *this;
  }

  std::string
  AllEvents() const
  {
    std::string all;
    for (const std::string & event : events)
    {
      all += event + "\n";
    }
    return all;
  }

  std::size_t
  Pieces(std::size_t slice) const
  {
    return sections[slice].pieces.size();
  }

  std::vector<Section>     sections;
  std::vector<std::string> events;

private:
  std::function<double(double, double, double)> m_F;
};

// Bone of 900 HU in a round section, blurred; soft tissue is 0 here.
double
Rod(double x, double y, double radius)
{
  return 900.0 * Blurred(radius - std::hypot(x, y), 0.5);
}

TEST(SectionFollower, FollowsABoneThatMovesAndWidensByManyPixels)
{
  Follow follow([](double x, double y, double z) { return 50.0 + Rod(x - 0.5 * z + 6.0, y, z < 12.0 ? 6.0 : 14.0); });
  follow.Draw(2, Ellipse(6.5, 5.5, 20, { -5.0, 0.4 })).Run();
  for (std::size_t k = 0; k < 24; ++k)
  {
    ASSERT_EQ(follow.Pieces(k), 1u) << k;
    const double radius = k < 12 ? 6.0 : 14.0;
    EXPECT_NEAR(std::sqrt(SignedArea(follow.sections[k].pieces[0].outer) / M_PI), radius, 1.0);
  }
  EXPECT_THAT(follow.events[12], HasSubstr("changes suddenly, by a factor of 4.8"));
}

TEST(SectionFollower, APieceThatJoinsBelongsToTheBoneOnAllItsSlices)
{
  // Two rods that meet at z = 12 and are one from there on.
  const auto two = [](double x, double y, double z) {
    const double apart = 15.0 - 0.75 * z;
    return 50.0 + std::max(Rod(x - apart, y, 6.0), Rod(x + apart, y, 6.0));
  };
  Follow below(two);
  below.Draw(2, Ellipse(6.0, 6.0, 30, { 13.5, 0.0 })).Run();
  EXPECT_EQ(below.Pieces(0), 2u);
  EXPECT_EQ(below.Pieces(5), 2u);
  EXPECT_EQ(below.Pieces(18), 1u);
  EXPECT_THAT(below.AllEvents(), HasSubstr("another piece joins"));
  Follow above(two);
  above.Draw(20, Ellipse(6.0, 6.0, 30)).Run();
  EXPECT_EQ(above.Pieces(5), 2u);
  EXPECT_EQ(above.Pieces(22), 1u);
}

TEST(SectionFollower, ABoneThatGoesUpAgainIsFollowedThere)
{
  // A U: one piece at the bottom, two legs, the second one longer than the first.
  Follow follow([](double x, double y, double z) {
    const double leg = z > 8.0 ? std::max(z < 16.0 ? Rod(x - 9.0, y, 5.0) : 0.0, Rod(x + 9.0, y, 5.0))
                               : 900.0 * Blurred(std::min(14.0 - std::abs(x), 5.0 - std::abs(y)), 0.5);
    return 50.0 + leg;
  });
  follow.Draw(13, Ellipse(5.0, 5.0, 30, { 9.0, 0.0 })).Run();
  EXPECT_EQ(follow.Pieces(4), 1u);
  EXPECT_EQ(follow.Pieces(12), 2u);
  EXPECT_EQ(follow.Pieces(20), 1u);
}

TEST(SectionFollower, BonesInContactStayApart)
{
  // A ball's sections in a socket, 1.2 mm apart: their cortices blur into each other above the threshold.
  const auto joint = [](double x, double y, double z) {
    const double r = std::hypot(x, y);
    const double ball = std::sqrt(std::max(0.0, 13.0 * 13.0 - (z - 10.0) * (z - 10.0)));
    const double bone = 400.0 * Blurred(ball - r, 0.5) + 600.0 * Blurred(ball - r, 0.5) * Blurred(r - ball + 1.5, 0.5);
    const double gap = 1.2 + std::max(0.0, 9.0 - z);
    const double socket = z > 5.0 && x > 0.0 ? 1000.0 * Blurred(r - ball - gap, 0.5) * Blurred(21.0 - r, 0.5) : 0.0;
    return 50.0 + bone + socket;
  };
  Follow follow(joint, 20);
  follow.Draw(2, Ellipse(10.2, 10.2, 40)).Run();
  for (std::size_t k = 0; k < 20; ++k)
  {
    const double z = static_cast<double>(k) - 10.0;
    ASSERT_EQ(follow.Pieces(k), 1u) << k;
    EXPECT_NEAR(std::sqrt(SignedArea(follow.sections[k].pieces[0].outer) / M_PI), std::sqrt(169.0 - z * z), 2.0 * Pixel)
      << k;
  }
  EXPECT_THAT(follow.AllEvents(), HasSubstr("touches another bone"));
}

TEST(SectionFollower, AGapIsReportedNotFilled)
{
  Follow follow([](double x, double y, double z) { return 50.0 + (z > 9.5 && z < 13.5 ? 0.0 : Rod(x, y, 7.0)); });
  follow.Draw(3, Ellipse(7.0, 7.0, 30)).Run();
  EXPECT_EQ(follow.Pieces(9), 1u);
  EXPECT_EQ(follow.Pieces(11), 0u);
  EXPECT_EQ(follow.Pieces(16), 0u);
  EXPECT_THAT(follow.events[9], HasSubstr("a gap: there is bone again 5 mm further on"));
}

TEST(SectionFollower, ADrawnContourOverridesAndIsFollowedFrom)
{
  // Two rods side by side; the one on the left is drawn below, the one on the right above.
  Follow follow(
    [](double x, double y, double) { return 50.0 + std::max(Rod(x - 12.0, y, 6.0), Rod(x + 12.0, y, 6.0)); });
  follow.Draw(2, Ellipse(6.0, 6.0, 30, { -12.0, 0.0 })).Draw(20, Ellipse(6.0, 6.0, 30, { 12.0, 0.0 })).Run();
  for (std::size_t k = 0; k < 24; ++k)
  {
    ASSERT_EQ(follow.Pieces(k), 1u);
    EXPECT_EQ(follow.sections[k].pieces[0].outer[0].x() > 0.0, k > 11) << k;
  }
}

TEST(SectionFollower, MarrowStaysWithinAForamenIsAHole)
{
  // A tube with fat in it; from z = 12 on, a canal through a solid part opens from its side.
  Follow follow([](double x, double y, double z) {
    const double tube = Rod(x, y, 14.0) - 1000.0 * Blurred(4.0 - std::hypot(x + 7.0, y), 0.5);
    const double canal = z < 8.0 ? 0.0 : 900.0 * Blurred(3.5 - (z < 14.0 ? std::abs(y) : std::hypot(x - 7.0, y)), 0.5);
    return 50.0 + tube - (x > 4.0 ? std::min(canal, Rod(x, y, 14.0)) : 0.0);
  });
  follow.Draw(2, Ellipse(14.0, 14.0, 50)).Run();
  ASSERT_EQ(follow.Pieces(2), 1u);
  EXPECT_EQ(follow.sections[2].pieces[0].holes.size(), 0u);
  ASSERT_EQ(follow.Pieces(20), 1u);
  EXPECT_EQ(follow.sections[20].pieces[0].holes.size(), 1u);
}
} // namespace SectionFollowerTests
} // namespace bone
