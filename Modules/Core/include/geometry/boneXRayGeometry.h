/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneXRayGeometry_h
#define boneXRayGeometry_h

#include "boneTypes.h"

#include <itkDataObject.h>
#include <itkObjectFactory.h>

namespace bone
{
/** \class XRayGeometry
 * \brief Source and flat detector of one radiographic view.
 *
 * Conventions: millimetres in ITK physical space (LPS). `DetectorOrigin` is the centre of pixel (0, 0); `DetectorU` and
 * `DetectorV` are unit vectors along increasing column and row, at right angles; pixel (c, r) is centred at
 * DetectorOrigin + c * Spacing[0] * DetectorU + r * Spacing[1] * DetectorV. With a point source, rays run from `Source`
 * to the pixel's centre; a parallel beam has a unit `Direction` from source to detector instead. A value of a
 * radiograph is the line integral from the source (parallel: from infinity) to the pixel. */
class XRayGeometry : public itk::DataObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(XRayGeometry);
  using Self = XRayGeometry;
  using Superclass = itk::DataObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(XRayGeometry, itk::DataObject);

  /** The numbers of a view. */
  struct View
  {
    bool               parallel{ false };
    Vector3            source{ 0, -1000, 0 }; ///< mm, point source
    Vector3            direction{ 0, 1, 0 };  ///< unit, parallel beam
    Vector3            detectorOrigin{ 0, 0, 0 };
    Vector3            detectorU{ 1, 0, 0 };
    Vector3            detectorV{ 0, 0, -1 };
    std::array<int, 2> size{ { 512, 512 } }; ///< columns, rows
    Vector2            spacing{ 1, 1 };      ///< mm
  };

  /** Throws itk::ExceptionObject where a number is not finite, a size or spacing is not positive, U and V are not unit
   * and perpendicular within 1e-6, or the source lies in (the beam runs along) the detector's plane. */
  void
  SetView(const View & view);
  itkGetConstReferenceMacro(View, View);

  /** Centre of pixel (column, row), mm; fractional pixels allowed. */
  Vector3
  GetPixelPoint(double column, double row) const;

  /** Where a point (mm) appears: column and row, fractional, of any size. With a point source, NaN for a point in or
   * behind the plane through the source that is parallel to the detector. */
  Vector2
  ProjectPoint(const Vector3 & point) const;

  /** A view of the box (lower, upper corner, mm) with the detector `sourceToDetector` mm from the source, the box's
   * centre at `sourceToCentre` mm, looking along the unit vector `beam` with image rows along -`up`, and just large
   * enough that the box projects inside; square pixels, the longer side `pixels` long. */
  static View
  Framing(const Vector3 & lower,
          const Vector3 & upper,
          const Vector3 & beam,
          const Vector3 & up,
          double          sourceToCentre,
          double          sourceToDetector,
          int             pixels);

  /** The same where the distances do not matter: 1000 and 1200 mm, and for boxes of more than 400 mm along the beam so
   * much more that they lie before the detector and twice as far from the source as they are deep. */
  static View
  Framing(const Vector3 & lower, const Vector3 & upper, const Vector3 & beam, const Vector3 & up, int pixels);

  void
  Graft(const itk::DataObject * data) override;

protected:
  XRayGeometry() = default;
  ~XRayGeometry() override = default;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  View m_View;
};
} // namespace bone

#endif
