/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelOutline_h
#define boneLabelOutline_h

#include "boneLabelValue.h"
#include "boneTypes.h"

#include <itkImageBase.h>

#include <algorithm>
#include <vector>

namespace bone
{
/** Where a label of an image ends: between which voxels its boundary is. In ITK physical space (mm). */
struct LabelOutline
{
  /** A voxel with a neighbour, across a face, on the other side. */
  struct Voxel
  {
    Vector3 centre;
    bool    inside;
  };

  /** What lies between two such voxels. */
  struct Face
  {
    Vector3 centre;
    Vector3 outward; ///< unit vector from the centre of the voxel inside to that of the other
    double  area;    ///< mm^2
  };

  std::vector<Voxel> voxels;
  std::vector<Face>  faces;
  double             spacing{ 0.0 }; ///< cube root of a voxel's volume, mm
};

/** The outline of a label; where it leaves the image there is none. `inside` says which voxels of the image's buffered
 * region, the first axis fastest, have the label. */
LabelOutline
FindOutline(const itk::ImageBase<3> & image, const std::vector<unsigned char> & inside);

/** The same for a label map of any scalar; label 0 stands for every value but 0. */
template <typename TImage>
LabelOutline
FindOutline(const TImage & labels, int label)
{
  const std::size_t          count = labels.GetBufferedRegion().GetNumberOfPixels();
  std::vector<unsigned char> inside(count);
  std::transform(labels.GetBufferPointer(),
                 labels.GetBufferPointer() + count,
                 inside.begin(),
                 [label](const auto & value) -> unsigned char { return HasLabel(value, label); });
  return FindOutline(static_cast<const itk::ImageBase<3> &>(labels), inside);
}
} // namespace bone

#endif
