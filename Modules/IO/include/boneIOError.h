/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneIOError_h
#define boneIOError_h

#include <itkMacro.h>

#include <string>

namespace bone
{
/** \class IOError
 * \brief What readers and writers throw: one line that names the file, what is wrong with it and what to do.
 *
 * `what()` is that line alone, unlike that of itk::ExceptionObject, which adds the place in the source. */
class IOError : public itk::ExceptionObject
{
public:
  /** The line is \ref OneLine of "path: message". */
  IOError(const std::string & path, const std::string & message);

  const char *
  what() const noexcept override
  {
    return this->GetDescription();
  }
  const char *
  GetNameOfClass() const override
  {
    return "IOError";
  }
};

/** \class MachineError
 * \brief Where the machine is at fault and not what it was asked for, as with a full disk or too little memory: another
 * time it may do. */
class MachineError : public IOError
{
public:
  using IOError::IOError;

  const char *
  GetNameOfClass() const override
  {
    return "MachineError";
  }
};

/** Throws MachineError that ends in the text of errno's `code`; IOError where there is no such place, or nobody may
 * write there, which is so another time too. */
[[noreturn]] void
RefuseToWrite(const std::string & path, const std::string & problem, int code);

/** The text with blanks for line breaks and other control characters, which names in files may hold, and none at its
 * end. */
std::string
OneLine(std::string text);

/** An exception's description as one line for a person: without ITK's "ITK ERROR: Class(address):" before it. */
std::string
ErrorLine(const itk::ExceptionObject & error);
} // namespace bone

#endif
