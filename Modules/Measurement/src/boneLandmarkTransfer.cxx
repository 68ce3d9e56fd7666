/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLandmarkTransfer.h"

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
  return PlaceLandmarks(subject, places);
}
} // namespace bone
