/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasRegistration.h"

#include "boneInteriorDeformation.h"
#include "boneRegistrationParameters.h"

#include "boneQualityMeasures.h"

#include <algorithm>
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

std::vector<TriangleSurface>
ReflectAll(std::vector<TriangleSurface> surfaces)
{
  for (TriangleSurface & surface : surfaces)
  {
    surface = Reflect(std::move(surface));
  }
  return surfaces;
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
  standard.region = mesh.region;
  standard.neighbors = mesh.neighbors.empty() ? ComputeFaceNeighbors(mesh.tetrahedra) : mesh.neighbors;
  return standard;
}

double
MeanDistance(const std::vector<Vector3> & points, const DirectedSurface & surface, const Execution & execution)
{
  std::vector<double> distance(points.size());
  execution.Silent().For(
    points.size(), [&](std::size_t p) { distance[p] = std::sqrt(surface.FindAny(points[p]).squaredDistance); }, 64);
  double sum = 0;
  for (const double d : distance)
  {
    sum += d;
  }
  return sum / static_cast<double>(points.size());
}
} // namespace

SubjectSurfaces
SurfacesOf(const MeshArrays & mesh)
{
  SubjectSurfaces     surfaces;
  std::vector<IdType> id;
  surfaces.exterior = ExteriorSurface(mesh, id);
  const int innermost = mesh.region.empty() ? 0 : *std::max_element(mesh.region.begin(), mesh.region.end());
  for (int least = 2; least <= innermost; ++least)
  {
    surfaces.inner.push_back(ExteriorSurface(mesh, id, least));
  }
  return surfaces;
}

StandardModel::StandardModel(const MeshArrays & mesh)
  : m_Mesh(TakeStandard(mesh))
  , m_Surface(ExteriorSurface(m_Mesh, m_SurfaceId))
  , m_FixedId(m_SurfaceId)
  , m_Interior(std::make_unique<InteriorDeformation>(m_Mesh, m_SurfaceId))
{
  const int innermost = m_Mesh.region.empty() ? 0 : *std::max_element(m_Mesh.region.begin(), m_Mesh.region.end());
  for (int least = 2; least <= innermost; ++least)
  {
    LayerSurface layer;
    layer.surface = ExteriorSurface(m_Mesh, layer.id, least);
    for (const IdType p : layer.id)
    {
      layer.exterior.push_back(std::binary_search(m_SurfaceId.begin(), m_SurfaceId.end(), p));
    }
    m_FixedId.insert(m_FixedId.end(), layer.id.begin(), layer.id.end());
    m_Layers.push_back(std::move(layer));
  }
  if (!m_Layers.empty())
  {
    std::sort(m_FixedId.begin(), m_FixedId.end());
    m_FixedId.erase(std::unique(m_FixedId.begin(), m_FixedId.end()), m_FixedId.end());
    m_BetweenLayers = std::make_unique<InteriorDeformation>(m_Mesh, m_FixedId);
  }
}

StandardModel::~StandardModel() = default;

void
StandardModel::FitLayers(const std::vector<TriangleSurface> & target,
                         const RegistrationParameters &       parameters,
                         const AffineMap &                    alignment,
                         std::vector<Vector3> &               points,
                         RegistrationReport &                 report,
                         const Execution &                    execution) const
{
  bool any = false;
  for (std::size_t k = 0; k < m_Layers.size(); ++k)
  {
    report.layerDistance.push_back(-1.0);
    if (k < target.size() && !target[k].triangles.empty())
    {
      const DirectedSurface there(target[k]);
      TriangleSurface       moved = m_Layers[k].surface;
      for (std::size_t i = 0; i < moved.points.size(); ++i)
      {
        moved.points[i] = points[m_Layers[k].id[i]];
      }
      FitFacets(moved, there, parameters.layers, m_Layers[k].exterior, execution);
      report.layerDistance.back() = MeanDistance(moved.points, there, execution);
      for (std::size_t i = 0; i < moved.points.size(); ++i)
      {
        points[m_Layers[k].id[i]] = moved.points[i];
      }
      any = true;
    }
  }
  if (any)
  {
    std::vector<Vector3> fixed;
    for (const IdType p : m_FixedId)
    {
      fixed.push_back(points[p]);
    }
    points = m_BetweenLayers->Deform(InteriorRule::Harmonic, alignment, fixed);
  }
}

std::vector<Vector3>
StandardModel::Register(const SubjectSurfaces &             subjects,
                        const AtlasRegistrationParameters & given,
                        RegistrationReport &                report,
                        const Execution &                   execution) const
{
  const RegistrationParameters parameters(given);
  const TriangleSurface &      subject = subjects.exterior;
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
    aligned = AlignSurfaces(m_Surface, *target, parameters.surfaceAlignment, execution.Part(0.0, 0.15));
  }
  if (parameters.mirror != MirrorMode::Never)
  {
    auto       reflected = std::make_unique<DirectedSurface>(Reflect(subject));
    const auto mirrored = AlignSurfaces(m_Surface, *reflected, parameters.surfaceAlignment, execution.Part(0.15, 0.3));
    if (target == nullptr || mirrored.distance < aligned.distance)
    {
      target = std::move(reflected);
      aligned = mirrored;
      report.mirrored = true;
    }
  }
  report.alignment = aligned.map;
  report.alignmentDistance = aligned.distance;
  execution.Report(0.3);
  TriangleSurface moved = m_Surface;
  for (Vector3 & x : moved.points)
  {
    x = aligned.map(x);
  }
  moved.points = parameters.method == DeformationMethod::AdaptiveFocus
                   ? DeformAdaptiveFocus(moved, *target, parameters.focus, execution.Part(0.3, 0.8))
                   : DeformNonRigidICP(moved, *target, parameters.nonRigid, execution.Part(0.3, 0.8));
  FitFacets(moved, *target, parameters.facets, {}, execution);
  execution.Report(0.83);
  std::vector<Vector3> points =
    m_Interior->Deform(parameters.interior, aligned.map, moved.points, execution.Part(0.83, 0.87));
  if (!subjects.inner.empty())
  {
    this->FitLayers(report.mirrored ? ReflectAll(subjects.inner) : subjects.inner,
                    parameters,
                    aligned.map,
                    points,
                    report,
                    execution.Part(0.87, 0.9));
  }
  report.untangling =
    UntangleMesh(m_Mesh, m_SurfaceId, aligned.map, points, parameters.untangling, execution.Part(0.9, 1.0));
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
  report.surfaceDistance = MeanDistance(moved.points, *target, execution);
  report.subjectDistance = MeanDistance(target->GetSurface().points, DirectedSurface(moved), execution);
  return points;
}
} // namespace bone
