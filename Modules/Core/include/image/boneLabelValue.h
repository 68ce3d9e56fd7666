/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelValue_h
#define boneLabelValue_h

#include <itkMetaDataObject.h>

#include <string>

namespace bone
{
/** \name Label maps of one bone
 * The values of a label map may be bones, or regions of one bone (cortical, trabecular, medullary cavity). A map that
 * holds regions says so in its header, where NIfTI has room for 23 characters: "aux_file", or any notes.
 * \{ */
constexpr const char * OneBoneNote = "regions of one bone";

inline void
StateOneBone(itk::Object & labels)
{
  itk::EncapsulateMetaData<std::string>(labels.GetMetaDataDictionary(), "aux_file", OneBoneNote);
}

inline bool
StatesOneBone(const itk::Object & labels)
{
  for (const char * field : { "aux_file", "descrip", "ITK_FileNotes" })
  {
    std::string notes;
    if (itk::ExposeMetaData(labels.GetMetaDataDictionary(), field, notes) &&
        notes.find(OneBoneNote) != std::string::npos)
    {
      return true;
    }
  }
  return false;
}
/** \} */

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
