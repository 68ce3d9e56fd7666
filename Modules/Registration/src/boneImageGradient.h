/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageGradient_h
#define boneImageGradient_h

#include <array>
#include <cstddef>
#include <vector>

namespace bone
{
/** \struct PixelBox
 * \brief The pixels of an image from a first column and row to before a last. */
struct PixelBox
{
  std::array<int, 2> first{ 0, 0 };
  std::array<int, 2> end{ 0, 0 };

  int
  Columns() const
  {
    return end[0] - first[0];
  }
  int
  Rows() const
  {
    return end[1] - first[1];
  }
  std::size_t
  GetNumberOfPixels() const
  {
    return static_cast<std::size_t>(this->Columns()) * static_cast<std::size_t>(this->Rows());
  }
};

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
  /** Writes the derivatives per pixel along columns (`x`) and rows (`y`), of the whole image or the pixels of a box. */
  void
  Apply(const float * image, float * x, float * y) const;
  void
  Apply(const float * image, const PixelBox & box, float * x, float * y) const;

private:
  int                m_Columns;
  int                m_Rows;
  std::vector<float> m_Smooth;
  std::vector<float> m_Derive;
};
} // namespace bone

#endif
