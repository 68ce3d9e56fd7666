/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSvgIds_h
#define boneSvgIds_h

#include <string>

namespace bone
{
/** Cairo's SVG with its ids and what refers to them renamed to prefix-1, prefix-2, ... in the order in which they are
 * defined: Cairo counts them over all pictures of a process, and calls letters alike in all of them. */
std::string
RenameSvgIds(const std::string & svg, const std::string & prefix);
} // namespace bone

#endif
