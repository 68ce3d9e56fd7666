/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelValue_h
#define boneLabelValue_h

namespace bone
{
/** Whether a voxel of a label map, of any scalar type, has a label; label 0 stands for every value but 0. NaN is none.
 */
template <typename TValue>
bool
HasLabel(const TValue & value, int label)
{
  const auto number = static_cast<double>(value);
  return label != 0 ? number == label : number < 0.0 || number > 0.0;
}
} // namespace bone

#endif
