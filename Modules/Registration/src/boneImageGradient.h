/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageGradient_h
#define boneImageGradient_h

#include <cstddef>
#include <vector>

namespace bone
{
/** \class ImageGradient
 * \brief Derivatives of an image along columns and rows, by the derivatives of a sampled Gaussian.
 *
 * Linear, and exact for images that are linear in column and row. Pixels nearer to the border than Radius() have no
 * derivative: 0. */
class ImageGradient
{
public:
  /** The image's size in pixels, the Gaussian's standard deviation in pixels, > 0. */
  ImageGradient(int columns, int rows, double sigma);

  int
  Radius() const
  {
    return static_cast<int>(m_Smooth.size()) / 2;
  }
  /** Writes the derivatives per pixel along columns (`x`) and rows (`y`). */
  void
  Apply(const float * image, float * x, float * y) const;

private:
  int                m_Columns;
  int                m_Rows;
  std::vector<float> m_Smooth;
  std::vector<float> m_Derive;
};
} // namespace bone

#endif
