/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneUtf8.h"

#include <cstddef>
#include <cstdint>

namespace bone
{
namespace
{
/** Bytes of the character that begins at `at`; 0 where there is none. */
std::size_t
CharacterLength(const std::string & text, std::size_t at)
{
  const auto        byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const std::size_t length = byte(at) < 0x80U            ? 1
                             : (byte(at) >> 5U) == 0x06U ? 2
                             : (byte(at) >> 4U) == 0x0EU ? 3
                             : (byte(at) >> 3U) == 0x1EU ? 4
                                                         : 0;
  if (length == 0 || at + length > text.size())
  {
    return 0;
  }
  std::uint32_t value = length == 1 ? byte(at) : byte(at) & (0x7FU >> length);
  for (std::size_t k = at + 1; k < at + length; ++k)
  {
    if ((byte(k) >> 6U) != 0x02U)
    {
      return 0;
    }
    value = value << 6U | (byte(k) & 0x3FU);
  }
  constexpr std::uint32_t least[5] = { 0, 0, 0x80U, 0x800U, 0x10000U };
  const bool              surrogate = value >= 0xD800U && value <= 0xDFFFU;
  return value < least[length] || value > 0x10FFFFU || surrogate ? 0 : length;
}
} // namespace

std::string
ToValidUtf8(const std::string & text)
{
  std::string valid;
  for (std::size_t at = 0; at < text.size();)
  {
    const std::size_t length = CharacterLength(text, at);
    if (length == 1)
    {
      const auto byte = static_cast<unsigned char>(text[at]);
      valid += byte < 0x20U || byte == 0x7FU ? ' ' : text[at];
    }
    else
    {
      valid += length == 0 ? "?" : text.substr(at, length);
    }
    at += length == 0 ? 1 : length;
  }
  return valid;
}
} // namespace bone
