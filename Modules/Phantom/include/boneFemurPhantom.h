/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFemurPhantom_h
#define boneFemurPhantom_h

#include "bonePhantomModel.h"

#include <cstdint>

namespace bone
{
/** Sizes (mm), angles (degrees) and densities (HU) of a \ref FemurPhantom; the defaults are the mean subject. Ranges in
 * brackets are those of ForSubject. */
struct FemurParameters
{
  double scale{ 1.0 };                   ///< of the positions of neck and trochanters [0.94, 1.06]
  double headRadius{ 23.5 };             ///< [21.5, 25.5]
  double neckRadius{ 15.0 };             ///< at its narrow end [13.8, 16.2]
  double neckLength{ 50.0 };             ///< from the shaft's axis to the centre of the head [46, 54]
  double neckShaftAngle{ 126.0 };        ///< [119, 133]
  double anteversion{ 12.0 };            ///< of the neck, forward of the frontal plane [2, 22]
  double shaftRadius{ 13.8 };            ///< across, in the middle of the shaft [12.6, 15]
  double bow{ 10.0 };                    ///< forward, of the shaft at the cut [6, 14]
  double length{ 190.0 };                ///< from the neck's foot down to the cut; all subjects alike
  double shaftCortex{ 5.2 };             ///< cortical thickness of the shaft [4.4, 6]
  double headCortex{ 1.3 };              ///< cortical thickness of the head; the least of all [1.15, 1.45]
  double calcarCortex{ 1.6 };            ///< additional thickness at the calcar [1.1, 2.1]
  double trabecularDepth{ 2.2 };         ///< least depth of trabecular bone around the medullary cavity
  double cavityRadius{ 11.0 };           ///< of the cavity's domed top
  double softTissueDensity{ 40.0 };      ///<
  double shaftDensity{ 1620.0 };         ///< cortical bone of the shaft [1540, 1700]
  double headDensity{ 1280.0 };          ///< cortical bone of the head [1210, 1350]
  double trabecularDensity{ 190.0 };     ///< trabecular bone away from head and bands [155, 225]
  double compressiveDensity{ 140.0 };    ///< additional, in the principal compressive band [100, 180]
  double trabecularHeadDensity{ 250.0 }; ///< additional, in the middle of the head [200, 300]
  double marrowDensity{ -50.0 };         ///< mean of the medullary cavity

  /** The subject of a seed: independent draws within the ranges, nearer to the mean more often. Seed 0 is the mean. The
   * same on every machine. */
  static FemurParameters
  ForSubject(std::uint64_t seed);
};

/** \class FemurPhantom
 * \brief Proximal two thirds of a right femur, from the head to a cut shaft.
 *
 * Space: LPS; the neck's axis meets the shaft's at the origin, the shaft runs along -z, the head lies at +x (medial)
 * and the neck leans to -y (forward). The bone goes on below z = -length, where GetExtent cuts it, so a CT of it ends
 * in bone: GetOpenStart() is true.
 *
 * Periosteal surface: smooth union of a spherical head, a conical neck, greater and lesser trochanter, and a bowed
 * shaft of elliptic cross-section with a linea aspera; exact sphere of `headRadius` over the head's free half.
 * Endosteal surface: at the depth t(x), smooth in space: `headCortex` in head and trochanters, thickening down the
 * shaft to `shaftCortex` 115 mm below the neck's foot, thicker at the calcar. Layers: nested everywhere, cortical
 * thickness at least 0.97 `headCortex`, trabecular bone at least 0.7 `trabecularDepth` around the cavity.
 *
 * Trabecular density (HU): base + head bump (17 mm wide) + principal compressive band from the head's crown to the
 * calcar (6.5 mm wide) + half as much in the tensile band from the greater trochanter to the head; lower down the
 * shaft. Cortical density falls from shaft to head and waves by 40 HU along the shaft. Marrow waves by 15 HU. All
 * smooth. */
class FemurPhantom : public PhantomModel
{
public:
  /** Throws itk::ExceptionObject where a size is not positive, the neck is not thinner than the head, the neck-shaft
   * angle lies outside 100..150 degrees, or the shaft is too thin to hold its layers. */
  explicit FemurPhantom(const FemurParameters & parameters = FemurParameters());
  explicit FemurPhantom(std::uint64_t seed)
    : FemurPhantom(FemurParameters::ForSubject(seed))
  {}

  int
  GetNumberOfSurfaces() const override
  {
    return 3;
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
  bool
  GetOpenStart() const override
  {
    return true;
  }

  const FemurParameters &
  GetParameters() const
  {
    return m_P;
  }
  const Vector3 &
  GetHeadCentre() const
  {
    return m_HeadCentre;
  }
  /** The shaft's axis at height z. */
  Vector3
  GetShaftCentre(double z) const;

private:
  template <typename T>
  std::array<T, 3>
  Evaluate(const Vector3 & x) const;

  FemurParameters m_P;
  Vector3         m_HeadCentre;
  Vector3         m_Calcar;
};
} // namespace bone

#endif
