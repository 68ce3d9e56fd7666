/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourStack.h"

#include "bonePlanarCrossing.h"

#include <Eigen/Geometry>

#include <cmath>
#include <sstream>

namespace bone
{
namespace
{
// Points may lie off their plane by what single precision leaves of a coordinate of a metre.
constexpr double PlaneTolerance = 1e-3;

std::string
Name(const ContourSlice & slice, std::size_t k, std::size_t c)
{
  std::ostringstream text;
  text << (slice.contours[c].axis ? "medial axis " : "contour ") << slice.contours[c].id << " (layer "
       << slice.contours[c].layer << ") of slice " << k;
  return text.str();
}

// What is wrong with a contour's points taken one by one; empty: nothing.
std::string
DescribeBadPoints(const Contour & contour, const ContourStack & stack, double height)
{
  const std::size_t n = contour.points.size();
  if (n < (contour.axis ? 1 : 3))
  {
    return contour.axis ? "has no point" : "has fewer than three points";
  }
  if (!contour.clearance.empty() && contour.clearance.size() != n)
  {
    return "has " + std::to_string(contour.clearance.size()) + " clearances for " + std::to_string(n) + " points";
  }
  for (std::size_t i = 0; i < n; ++i)
  {
    std::ostringstream text;
    if (!contour.points[i].allFinite())
    {
      text << "has a point that is not finite (point " << i << ")";
      return text.str();
    }
    const double off = contour.points[i].dot(stack.GetNormal()) - height;
    if (!(std::abs(off) <= PlaneTolerance))
    {
      text << "has a point " << off << " mm off the slice's plane (point " << i << ")";
      return text.str();
    }
    if ((!contour.axis || i + 1 < n) && stack.ToPlane(contour.points[i]) == stack.ToPlane(contour.points[(i + 1) % n]))
    {
      text << "repeats a point (point " << i << ")";
      return text.str();
    }
  }
  return {};
}
} // namespace

void
ContourStack::SetSlices(SliceContainer slices)
{
  m_Slices = std::move(slices);
  this->Modified();
}

void
ContourStack::SetFrame(const Vector3 & u, const Vector3 & v)
{
  const Vector3 unitU = u.normalized();
  const Vector3 across = v - v.dot(unitU) * unitU;
  if (!u.allFinite() || !v.allFinite() || !(u.norm() > 0.0) || !(across.norm() > 1e-9 * v.norm()))
  {
    itkExceptionMacro("The in-plane axes (" << u.transpose() << ") and (" << v.transpose()
                                            << ") must be finite and not parallel.");
  }
  m_U = unitU;
  m_V = across.normalized();
  m_Normal = m_U.cross(m_V);
  this->Modified();
}

std::size_t
ContourStack::GetNumberOfContours() const
{
  std::size_t count = 0;
  for (const ContourSlice & slice : m_Slices)
  {
    count += slice.contours.size();
  }
  return count;
}

void
ContourStack::Verify() const
{
  for (std::size_t k = 0; k < m_Slices.size(); ++k)
  {
    const ContourSlice & slice = m_Slices[k];
    if (!slice.origin.allFinite())
    {
      itkExceptionMacro("The origin of slice " << k << " is not finite.");
    }
    if (k > 0 && !(this->GetHeight(k) > this->GetHeight(k - 1)))
    {
      itkExceptionMacro("Slice " << k << " at " << this->GetHeight(k) << " mm is not above slice " << k - 1 << " at "
                                 << this->GetHeight(k - 1) << " mm: sort the slices along the normal.");
    }
    std::vector<PlanarChain> chains;
    for (std::size_t c = 0; c < slice.contours.size(); ++c)
    {
      const std::string wrong = DescribeBadPoints(slice.contours[c], *this, this->GetHeight(k));
      if (!wrong.empty())
      {
        itkExceptionMacro("The " << Name(slice, k, c) << ' ' << wrong << '.');
      }
      chains.push_back({ {}, !slice.contours[c].axis });
      for (const Vector3 & point : slice.contours[c].points)
      {
        chains.back().points.push_back(this->ToPlane(point));
      }
    }
    const PlanarCrossing crossing = FindPlanarCrossing(chains);
    if (crossing.found)
    {
      const std::size_t a = crossing.chain[0];
      const std::size_t b = crossing.chain[1];
      itkExceptionMacro("The " << Name(slice, k, a) << " crosses or touches "
                               << (a == b ? std::string("itself") : "the " + Name(slice, k, b)) << " near ("
                               << slice.contours[a].points[crossing.edge[0]].transpose() << ").");
    }
  }
}

void
ContourStack::Initialize()
{
  Superclass::Initialize();
  m_Slices.clear();
  m_U = Vector3::UnitX();
  m_V = Vector3::UnitY();
  m_Normal = Vector3::UnitZ();
  m_OpenStart = false;
  m_OpenEnd = false;
}

void
ContourStack::Graft(const itk::DataObject * data)
{
  const auto * other = dynamic_cast<const Self *>(data);
  if (data != nullptr && other == nullptr)
  {
    itkExceptionMacro("Cannot graft a " << data->GetNameOfClass() << " onto a ContourStack.");
  }
  Superclass::Graft(data);
  if (other != nullptr)
  {
    m_Slices = other->m_Slices;
    m_U = other->m_U;
    m_V = other->m_V;
    m_Normal = other->m_Normal;
    m_OpenStart = other->m_OpenStart;
    m_OpenEnd = other->m_OpenEnd;
  }
}

void
ContourStack::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Slices: " << m_Slices.size() << '\n';
  os << indent << "Contours: " << this->GetNumberOfContours() << '\n';
  os << indent << "U: " << m_U.transpose() << '\n';
  os << indent << "V: " << m_V.transpose() << '\n';
  os << indent << "Normal: " << m_Normal.transpose() << '\n';
  os << indent << "OpenStart: " << m_OpenStart << '\n';
  os << indent << "OpenEnd: " << m_OpenEnd << '\n';
}

double
SignedArea(const std::vector<Vector2> & polygon)
{
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    // Relative to the first point: no cancellation far from the origin.
    const Vector2 a = polygon[i] - polygon[0];
    const Vector2 b = polygon[(i + 1) % polygon.size()] - polygon[0];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * area;
}

double
Perimeter(const std::vector<Vector2> & polygon)
{
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    length += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
  }
  return length;
}

bool
PointInPolygon(const Vector2 & q, const std::vector<Vector2> & polygon)
{
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
  {
    const Vector2 & a = polygon[j];
    const Vector2 & b = polygon[i];
    if ((a.y() > q.y()) != (b.y() > q.y()) && q.x() < a.x() + (q.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
    {
      inside = !inside;
    }
  }
  return inside;
}
} // namespace bone
