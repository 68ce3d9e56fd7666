/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasRegistration.h"

#include "boneParallelLoop.h"
#include "boneQualityMeasures.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace bone
{
namespace
{
TriangleSurface
Reflect(TriangleSurface surface)
{
  surface.points = ReflectPoints(std::move(surface.points));
  for (auto & triangle : surface.triangles)
  {
    std::swap(triangle[1], triangle[2]);
  }
  return surface;
}

MeshArrays
TakeStandard(const MeshArrays & mesh)
{
  const std::size_t inverted = CountInverted(mesh);
  if (mesh.tetrahedra.empty() || inverted > 0)
  {
    std::ostringstream text;
    text << "The standard model must have tetrahedra, all positively oriented; of its " << mesh.tetrahedra.size()
         << ", " << inverted << " are flat or inverted.";
    throw std::invalid_argument(text.str());
  }
  MeshArrays standard;
  standard.points = mesh.points;
  standard.tetrahedra = mesh.tetrahedra;
  standard.neighbors = mesh.neighbors.empty() ? ComputeFaceNeighbors(mesh.tetrahedra) : mesh.neighbors;
  return standard;
}

double
MeanDistance(const std::vector<Vector3> & points, const DirectedSurface & surface)
{
  std::vector<double> distance(points.size());
  ParallelLoop(
    points.size(), 64, [&](std::size_t p) { distance[p] = std::sqrt(surface.FindAny(points[p]).squaredDistance); });
  double sum = 0;
  for (const double d : distance)
  {
    sum += d;
  }
  return sum / static_cast<double>(points.size());
}
} // namespace

std::vector<Vector3>
ReflectPoints(std::vector<Vector3> points)
{
  for (Vector3 & x : points)
  {
    x[0] = -x[0];
  }
  return points;
}

StandardModel::StandardModel(const MeshArrays & mesh)
  : m_Mesh(TakeStandard(mesh))
  , m_Surface(ExteriorSurface(m_Mesh, m_SurfaceId))
  , m_Interior(std::make_unique<InteriorDeformation>(m_Mesh, m_SurfaceId))
{}

std::vector<Vector3>
StandardModel::Register(const TriangleSurface &             subject,
                        const RegistrationParameters &      parameters,
                        RegistrationReport &                report,
                        const std::function<void(double)> & progress) const
{
  if (subject.triangles.empty())
  {
    throw std::invalid_argument("The subject has no surface.");
  }
  report = RegistrationReport();
  std::unique_ptr<DirectedSurface> target;
  SurfaceAlignmentResult           aligned;
  if (parameters.mirror != MirrorMode::Always)
  {
    target = std::make_unique<DirectedSurface>(subject);
    aligned = AlignSurfaces(m_Surface, *target, parameters.alignment);
  }
  if (parameters.mirror != MirrorMode::Never)
  {
    auto       reflected = std::make_unique<DirectedSurface>(Reflect(subject));
    const auto mirrored = AlignSurfaces(m_Surface, *reflected, parameters.alignment);
    if (target == nullptr || mirrored.distance < aligned.distance)
    {
      target = std::move(reflected);
      aligned = mirrored;
      report.mirrored = true;
    }
  }
  report.alignment = aligned.map;
  report.alignmentDistance = aligned.distance;
  progress(0.3);
  TriangleSurface moved = m_Surface;
  for (Vector3 & x : moved.points)
  {
    x = aligned.map(x);
  }
  moved.points = parameters.method == DeformationMethod::AdaptiveFocus
                   ? DeformAdaptiveFocus(moved, *target, parameters.focus)
                   : DeformNonRigidICP(moved, *target, parameters.nonRigid);
  FitFacets(moved, *target, parameters.facetPasses, parameters.facetBound);
  progress(0.9);
  std::vector<Vector3> points = m_Interior->Deform(parameters.interior, aligned.map, moved.points);
  report.untangling = UntangleMesh(m_Mesh, m_SurfaceId, aligned.map, points, parameters.untangling);
  if (report.untangling.after > 0)
  {
    std::ostringstream text;
    text << report.untangling.after << " of " << m_Mesh.tetrahedra.size()
         << " tetrahedra are inverted after the registration (" << report.untangling.before
         << " before their repair; surfaces are " << report.alignmentDistance
         << " mm apart after the alignment): the subject may be another bone, mirrored, or only a part.";
    throw std::runtime_error(text.str());
  }
  for (std::size_t i = 0; i < m_SurfaceId.size(); ++i)
  {
    moved.points[i] = points[m_SurfaceId[i]];
  }
  report.surfaceDistance = MeanDistance(moved.points, *target);
  report.subjectDistance = MeanDistance(target->GetSurface().points, DirectedSurface(moved));
  progress(1.0);
  return points;
}
} // namespace bone
