/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRefuse_h
#define boneRefuse_h

#include "boneIOError.h"

#include <new>
#include <sstream>

namespace bone
{
/** The parts written one after another. */
template <typename... TParts>
std::string
Say(const TParts &... parts)
{
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/** Throws an itk::ExceptionObject that says the parts; a reader puts the file's name before it. */
template <typename... TParts>
[[noreturn]] void
Refuse(const TParts &... parts)
{
  throw itk::ExceptionObject(__FILE__, __LINE__, Say(parts...));
}

/** Runs action() and turns what ITK throws, and a lack of memory, into an IOError that names the file. */
template <typename TAction>
auto
NamingFile(const std::string & path, TAction && action)
{
  try
  {
    return action();
  }
  catch (const IOError &)
  {
    throw;
  }
  catch (const itk::ExceptionObject & error)
  {
    throw IOError(path, ErrorLine(error));
  }
  catch (const std::bad_alloc &)
  {
    throw IOError(path, "is damaged, or needs more memory than there is");
  }
}
} // namespace bone

#endif
