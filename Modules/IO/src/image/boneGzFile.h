/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneGzFile_h
#define boneGzFile_h

#include <itk_zlib.h>

#include <memory>
#include <string>
#include <type_traits>

namespace bone
{
/** A file that zlib reads whether it is compressed or not. */
using GzFile = std::unique_ptr<std::remove_pointer_t<gzFile>, int (*)(gzFile)>;

/** Null where it cannot be opened. */
inline GzFile
OpenGz(const std::string & path)
{
  GzFile file(gzopen(path.c_str(), "rb"), gzclose);
  if (file)
  {
    gzbuffer(file.get(), 1u << 18);
  }
  return file;
}
} // namespace bone

#endif
