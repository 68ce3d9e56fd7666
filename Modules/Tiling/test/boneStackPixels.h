/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStackPixels_h
#define boneStackPixels_h

#include "boneContourStack.h"

#include <itkImage.h>

#include <vector>

namespace bone
{
/** Pixels over the plane of a stack's slices; those of the rim lie in no contour. */
struct PixelGrid
{
  Vector2 low;
  double  pixel; ///< mm
  int     nx, ny;
};

PixelGrid
PixelGridOf(const ContourStack & stack, double pixel);

/** A closed contour in the plane. */
struct PlaneContour
{
  std::vector<Vector2> polygon;
  int                  region;
  int                  layer;
  int                  id;
  int                  parent; ///< position of the smallest contour around it, -1: none
};

/** The closed contours of a slice, the largest first. */
std::vector<PlaneContour>
PlaneContoursOf(const ContourStack & stack, const ContourSlice & slice);

/** Writes a value to the pixels whose centre lies inside. */
void
FillPolygon(const PixelGrid & grid, const std::vector<Vector2> & polygon, int value, std::vector<int> & slice);

using StackMask = itk::Image<unsigned char, 3>;

/** Whether each pixel of the slices lies in the regions from `least` inward, with an empty slice before the first and
 * after the last. Of the whole body (least = 1) voids are filled, as the tiling does. `outside` is the number of parts
 * of all the rest. */
StackMask::Pointer
PixelsInside(const ContourStack & stack, int least, double pixel, int & outside);

using StackLabels = itk::Image<unsigned int, 3>;

/** Numbers the parts of a mask, joined over faces or corners, from 1. */
StackLabels::Pointer
LabelParts(StackMask * mask, bool corners, int & count);
} // namespace bone

#endif
