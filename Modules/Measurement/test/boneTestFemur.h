/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTestFemur_h
#define boneTestFemur_h

#include "boneLandmarkIO.h"
#include "boneTriangleSurface.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

/** A femur of spheres, a waisted neck and a straight shaft, whose measures are known. */
namespace bone::test
{
/** The surface where a function is 0 (below within), by marching tetrahedra on a grid; its vertices lie on it. */
inline TriangleSurface
MarchSurface(const std::function<double(const Vector3 &)> & f,
             const Vector3 &                                lower,
             const Vector3 &                                upper,
             double                                         step)
{
  std::array<int, 3> n;
  for (int a = 0; a < 3; ++a)
  {
    n[a] = static_cast<int>(std::ceil((upper[a] - lower[a]) / step)) + 1;
  }
  const auto id = [&](const std::array<int, 3> & at) {
    return static_cast<IdType>((at[2] * n[1] + at[1]) * n[0] + at[0]);
  };
  const auto place = [&](IdType i) {
    return Vector3(lower + step * Vector3(i % n[0], i / n[0] % n[1], i / n[0] / n[1]));
  };
  std::vector<double> values(static_cast<std::size_t>(n[0]) * n[1] * n[2]);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = f(place(static_cast<IdType>(i)));
  }
  TriangleSurface                         surface;
  std::map<std::array<IdType, 2>, IdType> known;
  const auto                              crossing = [&](IdType in, IdType out) {
    const auto [at, isNew] = known.insert({ { in, out }, static_cast<IdType>(surface.points.size()) });
    if (isNew)
    {
      Vector3 a = place(in), b = place(out);
      for (int i = 0; i < 40; ++i)
      {
        const Vector3 m = 0.5 * (a + b);
        (f(m) < 0.0 ? a : b) = m;
      }
      surface.points.push_back(a);
    }
    return at->second;
  };
  const auto add = [&](IdType a, IdType b, IdType c, const Vector3 & outward) {
    const auto & p = surface.points;
    const bool   turned = (p[b] - p[a]).cross(p[c] - p[a]).dot(outward) < 0.0;
    surface.triangles.push_back({ a, turned ? c : b, turned ? b : c });
  };
  constexpr std::array<std::array<int, 3>, 6> orders = {
    { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } }
  };
  for (int cube = 0; cube < (n[0] - 1) * (n[1] - 1) * (n[2] - 1); ++cube)
  {
    const std::array<int, 3> first = { cube % (n[0] - 1),
                                       cube / (n[0] - 1) % (n[1] - 1),
                                       cube / (n[0] - 1) / (n[1] - 1) };
    for (const auto & order : orders)
    {
      std::array<int, 3>  at = first;
      std::vector<IdType> in, out;
      for (int corner = 0; corner < 4; ++corner)
      {
        (values[id(at)] < 0.0 ? in : out).push_back(id(at));
        at[order[std::min(corner, 2)]] += corner < 3 ? 1 : 0;
      }
      if (in.empty() || out.empty())
      {
        continue;
      }
      const Vector3 outward = place(out[0]) + place(out.back()) - place(in[0]) - place(in.back());
      if (in.size() == 2)
      {
        const IdType a = crossing(in[0], out[0]), b = crossing(in[0], out[1]), c = crossing(in[1], out[1]),
                     d = crossing(in[1], out[0]);
        add(a, b, c, outward);
        add(a, c, d, outward);
      }
      else if (in.size() == 1)
      {
        add(crossing(in[0], out[0]), crossing(in[0], out[1]), crossing(in[0], out[2]), outward);
      }
      else
      {
        add(crossing(in[0], out[0]), crossing(in[1], out[0]), crossing(in[2], out[0]), outward);
      }
    }
  }
  return surface;
}

struct FemurShape
{
  double headRadius{ 23.0 };    ///< mm
  double neckLength{ 52.0 };    ///< mm, from the shaft's axis to the head's centre
  double neckShaftAngle{ 127 }; ///< degrees
  double anteversion{ 15.0 };   ///< degrees
  double neckRadius{ 13.5 };    ///< mm, at its waist, 30 mm from the head's centre
  double medialRise{ 0.0 };     ///< mm, of the medial condyle above the lateral one

  /** From the shaft's axis to the head: a right femur in LPS. */
  Vector3
  NeckDirection() const
  {
    const double lean = (180.0 - neckShaftAngle) * M_PI / 180.0, turn = anteversion * M_PI / 180.0;
    return { std::sin(lean) * std::cos(turn), -std::sin(lean) * std::sin(turn), std::cos(lean) };
  }
  Vector3
  HeadCentre() const
  {
    return neckLength * this->NeckDirection();
  }
  double
  operator()(const Vector3 & x) const
  {
    const auto segment = [&x](const Vector3 & a, const Vector3 & b) {
      const double t = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      return (x - a - t * (b - a)).norm();
    };
    const double head = (x - this->HeadCentre()).norm() - headRadius;
    const double along = this->NeckDirection().dot(x);
    const double fromWaist = along - (neckLength - 30.0);
    const double neck =
      std::max({ (x - along * this->NeckDirection()).norm() - neckRadius - 0.008 * fromWaist * fromWaist,
                 along - neckLength,
                 -along });
    const double shaft = segment(Vector3(0, 0, 0), Vector3(0, 0, -350)) - 14.3;
    const double medial = (x - Vector3(21, 0, -350 + medialRise)).norm() - 20.2;
    const double lateral = (x - Vector3(-21, 0, -350)).norm() - 20.2;
    return std::min({ head, neck, shaft, medial, lateral });
  }
  TriangleSurface
  Surface(double step = 2.9) const
  {
    return MarchSurface(*this, Vector3(-45.1, -50.3, -375.7), Vector3(75.2, 40.4, 75.6), step);
  }
  /** A few millimetres off. */
  std::vector<Landmark>
  Landmarks() const
  {
    return { { "femoral_head", this->HeadCentre() + Vector3(3, -2, 4) },
             { "femoral_neck", 0.5 * this->HeadCentre() + Vector3(-2, 3, 1) },
             { "shaft_proximal", Vector3(12, 3, -60) },
             { "shaft_distal", Vector3(-4, 13, -200) },
             { "medial_condyle", Vector3(25, 18, -345) },
             { "lateral_condyle", Vector3(-16, 17, -356) } };
  }
};
} // namespace bone::test

#endif
