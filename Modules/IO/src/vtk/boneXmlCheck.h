/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneXmlCheck_h
#define boneXmlCheck_h

#include <string>

namespace bone
{
/** Throws IOError where an XML file would lead VTK's readers beyond the stack or their buffers: elements nested too
 * deep, counts that are no numbers or are more than a file of this size can hold, binary arrays that are shorter than
 * they say. Whether it is well formed is theirs to say. */
void
RequireSoundXml(const std::string & path);
} // namespace bone

#endif
