/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDescribe_h
#define boneDescribe_h

#include "boneContourStack.h"
#include "boneDensityHierarchy.h"
#include "boneLabelIO.h"
#include "boneStatisticalModel.h"
#include "boneXRayGeometry.h"

#include <string>

namespace bone
{
/** \defgroup Describe What is in a data object, as lines of text
 * \{ */
std::string
DescribeQuality(const MeshArrays & mesh);
std::string
DescribeMesh(const MeshArrays & mesh);
std::string
DescribeContours(const ContourStack & stack);
std::string
DescribeHierarchy(const DensityHierarchy<> & hierarchy);
std::string
DescribeView(const XRayGeometry & geometry);
std::string
DescribeModel(const StatisticalModel & model);
/** Where its values are few and whole, with a row for each label. */
std::string
DescribeImage(const CTImage & image, const std::vector<LabelName> & names);
/** Grid and labels of a file whose labels may overlap. */
std::string
DescribeLabelFile(const LabelFile & file);
/** \} */
} // namespace bone

#endif
