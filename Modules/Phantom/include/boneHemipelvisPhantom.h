/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHemipelvisPhantom_h
#define boneHemipelvisPhantom_h

#include "bonePhantomModel.h"

#include <cstdint>

namespace bone
{
/** Sizes (mm), angles (degrees) and densities (HU) of a \ref HemipelvisPhantom; the defaults are the mean subject.
 * Ranges in brackets are those of ForSubject. */
struct HemipelvisParameters
{
  double scale{ 1.0 };                  ///< of all positions and sizes but those below [0.93, 1.07]
  double cupRadius{ 26.0 };             ///< of the acetabulum [24, 28]
  double inclination{ 45.0 };           ///< of the acetabulum's opening below the lateral direction [39, 51]
  double cupAnteversion{ 18.0 };        ///< of the opening forward [10, 26]
  double wingThickness{ 4.0 };          ///< in the middle of the wing [3.4, 4.6]
  double crestThickness{ 10.0 };        ///< of the wing at its edge [8.6, 11.4]
  double wingRadius{ 115.0 };           ///< of the wing's bend [100, 130]
  double ramusRadius{ 7.0 };            ///< of the inferior pubic ramus [6.2, 7.8]
  double cortex{ 1.4 };                 ///< least cortical thickness [1.25, 1.55]
  double wingCortex{ 1.1 };             ///< additional depth of the endosteum in the middle of the wing [0.9, 1.3]
  double softTissueDensity{ 40.0 };     ///<
  double corticalDensity{ 1320.0 };     ///< [1240, 1400]
  double trabecularDensity{ 180.0 };    ///< away from the acetabulum [145, 215]
  double trabecularCupDensity{ 260.0 }; ///< additional, at the acetabulum's wall [210, 310]

  /** The subject of a seed: independent draws within the ranges, nearer to the mean more often. Seed 0 is the mean. The
   * same on every machine. */
  static HemipelvisParameters
  ForSubject(std::uint64_t seed);
};

/** \class HemipelvisPhantom
 * \brief A right hip bone: bent wing with a thick crest, acetabulum, ischium and pubis around the obturator foramen.
 *
 * Space: LPS; the centre of the acetabulum is the origin, medial is +x, backward +y, up +z. The bone is closed, has no
 * medullary cavity, and its surface is a smooth union of a cylindrically bent plate and round cones, with a spherical
 * bowl of `cupRadius` cut out of it, which opens sideways, forward and down. Slices across z have a hole at the
 * acetabulum's roof and two contours at the obturator foramen.
 *
 * Endosteal surface: at a depth of `cortex`, more in the middle of the wing, where opposite cortices meet and no
 * trabecular layer is left, and at the acetabulum's wall. Cortical thickness is at least 0.97 `cortex`.
 *
 * Trabecular density (HU): base + bump at the acetabulum's wall (14 mm deep); cortical density waves by 60 HU. All
 * smooth.
 */
class HemipelvisPhantom : public PhantomModel
{
public:
  /** Throws itk::ExceptionObject where a size is not positive or the wing is thicker than its crest. */
  explicit HemipelvisPhantom(const HemipelvisParameters & parameters = HemipelvisParameters());
  explicit HemipelvisPhantom(std::uint64_t seed)
    : HemipelvisPhantom(HemipelvisParameters::ForSubject(seed))
  {}

  int
  GetNumberOfSurfaces() const override
  {
    return 2;
  }
  Levels
  EvaluateLevels(const Vector3 & x) const override;
  Levels
  EvaluateLevels(const Vector3 & x, Gradients & gradients) const override;
  double
  GetLipschitzBound(int surface) const override;
  Materials
  EvaluateMaterials(const Vector3 & x, const Levels & levels) const override;
  Interval
  GetExtent(const Vector3 & direction) const override;

  const HemipelvisParameters &
  GetParameters() const
  {
    return m_P;
  }
  /** Unit vector out of the acetabulum. */
  const Vector3 &
  GetOpening() const
  {
    return m_Opening;
  }
  /** A point in the middle of the wing, halfway between its faces. */
  const Vector3 &
  GetWingCentre() const
  {
    return m_WingCentre;
  }

private:
  template <typename T>
  std::array<T, 2>
  Evaluate(const Vector3 & x) const;

  HemipelvisParameters m_P;
  Vector3              m_Opening;
  Vector3              m_WingCentre;
  Vector3              m_WingU;      ///< forward edge to backward edge
  Vector3              m_WingV;      ///< up to the crest
  Vector3              m_WingNormal; ///< to the concave, medial face
};
} // namespace bone

#endif
