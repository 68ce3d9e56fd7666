/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageHeader_h
#define boneImageHeader_h

#include <algorithm>
#include <array>
#include <cstring>
#include <istream>
#include <map>
#include <string>

namespace bone
{
/** The number that these bytes of a file are. */
template <typename T>
T
Decode(const char * bytes, bool swapped)
{
  std::array<char, sizeof(T)> ordered;
  std::copy_n(bytes, sizeof(T), ordered.begin());
  if (swapped)
  {
    std::reverse(ordered.begin(), ordered.end());
  }
  T value;
  std::memcpy(&value, ordered.data(), sizeof(T));
  return value;
}

/** The text without blanks at both ends. */
std::string
Trim(const std::string & text);

/** The fields of a MetaImage's header, up to and with ElementDataFile, after which the data may come. */
std::map<std::string, std::string>
ReadMetaHeader(std::istream & stream);

/** The fields of an NRRD's header, up to the empty line before the data. */
std::map<std::string, std::string>
ReadNrrdHeader(std::istream & stream);

/** The notes in an NRRD's header ("key:=value"), up to the empty line before the data. */
std::map<std::string, std::string>
ReadNrrdNotes(std::istream & stream);

/** Throws IOError where the header of a NIfTI, MetaImage or NRRD file has numbers that no image has: ITK's readers run
 * for ever, use up the memory or end the process with some of them. Other files are passed over. */
void
RequireSensibleHeader(const std::string & path);
} // namespace bone

#endif
