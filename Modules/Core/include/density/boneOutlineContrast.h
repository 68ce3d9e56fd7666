/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneOutlineContrast_h
#define boneOutlineContrast_h

#include <string>
#include <vector>

namespace bone
{
/** \class OutlineContrast
 * \brief What a CT has on both sides of a bone's outline: by it a CT and an outline that do not belong together are
 * found, and values that are not in HU.
 *
 * Along the outline of a bone the CT is brighter within than a few millimetres outside, in 0.73 (a femur's head with a
 * nail, voxels of 3 mm) to 0.98 of its places; along an outline that is mirrored, or shifted across the bone by 5 mm or
 * more, in about half. A shift along a shaft, or of a bone that is its own mirror image, is not seen. */
class OutlineContrast
{
public:
  /** How far beyond the outline to look (mm), in an image whose largest spacing is `pixel` (mm). */
  static double
  ReachOutside(double pixel);

  /** One place of the outline that stands for so much of it; values that are not finite do not count. */
  void
  Add(double inside, double outside, double weight);
  void
  Add(const OutlineContrast & other);

  /** Share of the outline with the higher value inside; 1 where too few places are known to tell. */
  double
  GetBrighterShare() const;

  /** One line, or nothing: that fewer places are brighter inside than any bone's outline has. `outline` is what may not
   * belong to the CT. */
  std::string
  FindMismatch(const std::string & outline) const;

  /** One line, or nothing: that the values beside the bone, or at its rim, are not those of bone in HU. */
  std::string
  FindForeignUnits() const;

private:
  double             m_Brighter{ 0.0 };
  double             m_Weight{ 0.0 };
  std::vector<float> m_Inside;
  std::vector<float> m_Outside;
};
} // namespace bone

#endif
