/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePageParts_h
#define bonePageParts_h

#include "boneColor.h"
#include "boneJson.h"
#include "bonePlaneView.h"

#include <cstdio>
#include <string>

namespace bone
{
/** "#rrggbb" */
inline std::string
ToHex(const Color & color)
{
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", color[0], color[1], color[2]);
  return text;
}

inline nlohmann::json
PackLetters(const SideLetters & letters)
{
  return { { "left", letters.left }, { "right", letters.right }, { "top", letters.top }, { "bottom", letters.bottom } };
}
} // namespace bone

#endif
