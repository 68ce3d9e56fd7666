/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLandmarkTransfer.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace bone
{
namespace
{
template <typename... TParts>
[[noreturn]] void
RefuseTransfer(const TParts &... parts)
{
  std::ostringstream text;
  (text << ... << parts);
  throw std::invalid_argument(text.str());
}

constexpr double      OnSurface = 2.0;  // mm: a landmark so near to the surface is one on it
constexpr double      Around = 2.0;     // of its distance: how far points around a landmark in the open reach
constexpr std::size_t LeastAround = 12; // of them

/** Where a landmark outside the standard goes with the points of the surface around it: by the similarity that fits
 * their motion best. */
Vector3
CarryOutside(const MeshArrays & standard, const Landmark & landmark, double distance, const MeshArrays & subject)
{
  std::vector<std::size_t> ids;
  for (double reach = Around * distance; ids.size() < std::min(LeastAround, standard.points.size()); reach *= 1.5)
  {
    ids.clear();
    for (std::size_t i = 0; i < standard.points.size(); ++i)
    {
      if ((standard.points[i] - landmark.point).norm() < reach)
      {
        ids.push_back(i);
      }
    }
  }
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(ids.size())), to = from;
  for (std::size_t i = 0; i < ids.size(); ++i)
  {
    from.col(static_cast<Eigen::Index>(i)) = standard.points[ids[i]];
    to.col(static_cast<Eigen::Index>(i)) = subject.points[ids[i]];
  }
  const Eigen::Matrix4d map = Eigen::umeyama(from, to, true);
  return map.topLeftCorner<3, 3>() * landmark.point + map.topRightCorner<3, 1>();
}
} // namespace

std::vector<LandmarkPlace>
LocateLandmarks(const MeshArrays & mesh, const std::vector<Landmark> & landmarks)
{
  if (mesh.tetrahedra.empty())
  {
    RefuseTransfer("A model without tetrahedra holds no landmarks.");
  }
  const TetraLocator         locator(mesh);
  std::vector<LandmarkPlace> places;
  for (const Landmark & landmark : landmarks)
  {
    places.push_back({ landmark.name, locator.FindNearest(landmark.point) });
  }
  return places;
}

std::vector<Landmark>
PlaceLandmarks(const MeshArrays & mesh, const std::vector<LandmarkPlace> & places)
{
  std::vector<Landmark> landmarks;
  for (const LandmarkPlace & at : places)
  {
    const IdType cell = at.place.cell;
    if (cell < 0 || static_cast<std::size_t>(cell) >= mesh.tetrahedra.size())
    {
      RefuseTransfer("Landmark '",
                     at.name,
                     "' lies in tetrahedron ",
                     cell,
                     ", where the model has ",
                     mesh.tetrahedra.size(),
                     ": it is of another topology.");
    }
    Vector3 point = Vector3::Zero();
    for (int i = 0; i < 4; ++i)
    {
      point += at.place.mu[i] * mesh.points[mesh.tetrahedra[cell][i]];
    }
    landmarks.push_back({ at.name, point });
  }
  return landmarks;
}

void
RequireSameTopology(const MeshArrays & standard, const MeshArrays & subject)
{
  const auto differ = [](const char * what, std::size_t a, std::size_t b) {
    if (a != b)
    {
      RefuseTransfer("The models are not of one topology: the standard has ", a, " ", what, ", the subject ", b, ".");
    }
  };
  differ("points", standard.points.size(), subject.points.size());
  differ("tetrahedra", standard.tetrahedra.size(), subject.tetrahedra.size());
  for (std::size_t t = 0; t < standard.tetrahedra.size(); ++t)
  {
    if (standard.tetrahedra[t] != subject.tetrahedra[t])
    {
      RefuseTransfer("The models are not of one topology: tetrahedron ", t, " has other points.");
    }
  }
}

std::vector<Landmark>
CarryLandmarks(const MeshArrays &            standard,
               const std::vector<Landmark> & landmarks,
               const MeshArrays &            subject,
               double                        farthest)
{
  RequireSameTopology(standard, subject);
  const auto places = LocateLandmarks(standard, landmarks);
  for (const LandmarkPlace & at : places)
  {
    if (!(at.place.distance <= farthest))
    {
      RefuseTransfer("Landmark '",
                     at.name,
                     "' lies ",
                     at.place.distance,
                     " mm from the standard model, where ",
                     farthest,
                     " mm are the most: place it on that model.");
    }
  }
  auto carried = PlaceLandmarks(subject, places);
  for (std::size_t i = 0; i < carried.size(); ++i)
  {
    if (places[i].place.distance > OnSurface)
    {
      carried[i].point = CarryOutside(standard, landmarks[i], places[i].place.distance, subject);
    }
  }
  return carried;
}
} // namespace bone
