/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMedialAxisFilter_h
#define boneMedialAxisFilter_h

#include "boneContourStackFilter.h"
#include "boneContourStackParameters.h"

namespace bone
{
/** \class MedialAxisFilter
 * \brief Adds the pruned medial axis of each innermost contour as the innermost layer (paper 2.1).
 *
 * The output has the input's closed contours and, for each of them that is no hole and holds nothing but holes, the
 * axis of the bone in it: polylines with `axis` set, the contour's layer + 1, its region, and each point's `clearance`.
 * Branches share their end points and form a tree, with a cycle around each hole; a round contour has a single point.
 * Axes of the input are replaced. The axis is that of the contours' Voronoi diagram, cut back from its ends by the
 * chord residual of R. Ogniewicz, O. Kuebler, doi:10.1016/0031-3203(94)00105-U. Parameters: \ref MedialAxisParameters.
 */
class MedialAxisFilter : public ContourStackFilter
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(MedialAxisFilter);
  using Self = MedialAxisFilter;
  using Superclass = ContourStackFilter;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(MedialAxisFilter, ContourStackFilter);

  BONE_PLAIN_FILTER_PARAMETERS(MedialAxisParameters, BONE_MEDIAL_AXIS_PARAMETERS)

protected:
  MedialAxisFilter() = default;
  ~MedialAxisFilter() override = default;

  ContourSlice
  MakeSlice(const ContourStack & input, std::size_t k) override;
};
} // namespace bone

#endif
