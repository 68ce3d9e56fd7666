/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourStack_h
#define boneContourStack_h

#include "boneTypes.h"

#include <itkDataObject.h>
#include <itkObjectFactory.h>

#include <vector>

namespace bone
{
/** One polyline on a slice. */
struct Contour
{
  /** Points in physical space (mm), on the slice's plane. A closed contour does not repeat its first point. */
  std::vector<Vector3> points;
  /** 0 periosteal (exterior), 1 endosteal, 2 boundary of the medullary cavity; a medial axis has one more than the
   * contour it lies in. */
  int layer{ 0 };
  /** Id of the contour, unique on its slice. */
  int id{ 0 };
  /** Region of the material just inside (see \ref Region); a hole (foramen) is a contour with region Outside. */
  int region{ Region::Cortical };
  /** True for an open polyline (or a single point) of a medial axis, false for a closed contour. */
  bool axis{ false };
  /** Of a medial axis: each point's distance to the nearest contour (mm); may be empty. */
  std::vector<double> clearance;
};

/** The contours of one plane. */
struct ContourSlice
{
  /** A point on the plane (mm). */
  Vector3              origin{ Vector3::Zero() };
  std::vector<Contour> contours;
};

/** \class ContourStack
 * \brief Parallel slices in order, each with closed contours by layer and medial-axis polylines.
 *
 * All slices share a right-handed frame: in-plane unit vectors U, V and the normal N = U x V along which the slices'
 * origins increase. Seen against N (looking at +N from its tip), closed contours around bone run counter-clockwise and
 * holes clockwise. A contour's material is that of its `region`. Units are millimetres in ITK physical space (LPS).
 *
 * The stack says where the bone leaves the image (`GetOpenStart`, `GetOpenEnd`): there it is cut flat, else its end is
 * closed. */
class ContourStack : public itk::DataObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourStack);
  using Self = ContourStack;
  using Superclass = itk::DataObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(ContourStack, itk::DataObject);

  using SliceContainer = std::vector<ContourSlice>;

  itkGetConstReferenceMacro(Slices, SliceContainer);
  /** Replaces all slices. */
  void
  SetSlices(SliceContainer slices);

  /** Sets the in-plane axes, made orthonormal; N = U x V. Throws where they are parallel or not finite. */
  void
  SetFrame(const Vector3 & u, const Vector3 & v);
  itkGetConstReferenceMacro(U, Vector3);
  itkGetConstReferenceMacro(V, Vector3);
  itkGetConstReferenceMacro(Normal, Vector3);

  /** True where the bone goes on beyond the first (last) slice because the image ends there. */
  itkSetMacro(OpenStart, bool);
  itkGetConstMacro(OpenStart, bool);
  itkSetMacro(OpenEnd, bool);
  itkGetConstMacro(OpenEnd, bool);

  /** Position of slice k along the normal (mm). */
  double
  GetHeight(std::size_t k) const
  {
    return m_Slices[k].origin.dot(m_Normal);
  }
  /** Mean distance of neighbouring slices (mm); 0 for fewer than two. */
  double
  GetMeanSliceDistance() const
  {
    const std::size_t count = m_Slices.size();
    return count < 2 ? 0.0 : (this->GetHeight(count - 1) - this->GetHeight(0)) / static_cast<double>(count - 1);
  }
  /** In-plane coordinates (mm) of a physical point: (p . U, p . V). */
  Vector2
  ToPlane(const Vector3 & p) const
  {
    return { p.dot(m_U), p.dot(m_V) };
  }
  /** The physical point of in-plane coordinates at a height along the normal; inverse of ToPlane and GetHeight. */
  Vector3
  FromPlane(const Vector2 & q, double height) const
  {
    return q.x() * m_U + q.y() * m_V + height * m_Normal;
  }

  /** Number of closed contours and axes in all slices. */
  std::size_t
  GetNumberOfContours() const;

  /** Throws itk::ExceptionObject, naming slice and contour, where: heights do not increase; clearances are not as many
   * as points; a closed contour has fewer than three points or crosses or touches itself or another contour of its
   * slice; a point is not finite or off its plane. O(n log n). */
  void
  Verify() const;

  void
  Initialize() override;
  void
  Graft(const itk::DataObject * data) override;

protected:
  ContourStack() = default;
  ~ContourStack() override = default;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  SliceContainer m_Slices;
  Vector3        m_U{ Vector3::UnitX() };
  Vector3        m_V{ Vector3::UnitY() };
  Vector3        m_Normal{ Vector3::UnitZ() };
  bool           m_OpenStart{ false };
  bool           m_OpenEnd{ false };
};

/** Signed area (mm^2) of a closed polygon in the plane, positive counter-clockwise. */
double
SignedArea(const std::vector<Vector2> & polygon);

/** Length (mm) of a closed polygon in the plane. */
double
Perimeter(const std::vector<Vector2> & polygon);

/** True where q lies inside the closed polygon (crossing number; points on the edge may go either way). */
bool
PointInPolygon(const Vector2 & q, const std::vector<Vector2> & polygon);
} // namespace bone

#endif
