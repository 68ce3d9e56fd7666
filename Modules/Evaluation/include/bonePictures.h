/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePictures_h
#define bonePictures_h

#include "boneContourStack.h"
#include "boneFigure.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup Pictures What a person looks at after a build
 * \{ */

/** \brief Six slices of the CT (or all, of fewer), evenly over the stack, with the contours drawn on them in the
 * colours of \ref ContourStyles.
 *
 * Titles tell the slices of `whole`, the CT as it is in its file, of which `ct` may be a part; null: `ct` itself.
 * Throws std::invalid_argument for a stack without slices. */
Canvas
DrawSlices(const CTImage *           ct,
           const ContourStack *      stack,
           const Window &            window,
           const std::string &       unit,
           const itk::ImageBase<3> * whole = nullptr);

/** A panel of one level of the model and its name. */
struct LevelPanel
{
  std::string name;
  Panel       panel;
};

/** A reference and the levels compared with it, in one view. */
struct Comparison
{
  std::string             title; ///< the plane, or the view
  SideLetters             letters;
  Vector2                 pixelSize{ 1, 1 }; ///< of a column and a row, mm
  std::string             scaleNote;         ///< where the pixel size holds
  std::string             referenceName{ "CT" };
  Panel                   reference;
  std::vector<LevelPanel> levels;
  Window                  window;       ///< of reference and levels
  double                  scale{ 1.0 }; ///< of a difference in full colour
  std::string             unit;
};

/** The comparisons below one another: the reference, then each level and below it its difference to the reference, red
 * where the model is higher, in full colour at `scale`. No difference is drawn where both are 0: beside the bone on a
 * radiograph. */
Canvas
DrawComparison(const std::vector<Comparison> & comparisons);
/** \} */
} // namespace bone

#endif
