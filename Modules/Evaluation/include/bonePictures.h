/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePictures_h
#define bonePictures_h

#include "boneContourStack.h"
#include "bonePlaneView.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup Pictures What a person looks at after a build
 * \{ */

/** Six slices of the CT, evenly over the stack, with the contours drawn on them: periosteal red, endosteal yellow,
 * medullary cyan, holes magenta, medial axes green. */
PictureImage::Pointer
DrawSlices(const CTImage * ct, const ContourStack * stack, const Window & window);

/** A panel of one level of the model and its name. */
struct LevelPanel
{
  std::string name;
  Panel       panel;
};

/** The reference in the first column, below one another each level beside it and its difference to the reference:
 * red where the model is higher, in full colour at `scale`. */
PictureImage::Pointer
DrawComparison(const Panel &                   reference,
               const std::string &             referenceName,
               const std::vector<LevelPanel> & levels,
               const Window &                  window,
               double                          scale);
/** \} */
} // namespace bone

#endif
