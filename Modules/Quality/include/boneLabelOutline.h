/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelOutline_h
#define boneLabelOutline_h

#include "boneTypes.h"

#include <itkImage.h>

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

/** The outline of a label. Where it leaves the image there is none.
 * \param label  0: of all labels but 0. */
LabelOutline
FindOutline(const itk::Image<short, 3> & labels, short label);
} // namespace bone

#endif
