/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTestDicom_h
#define boneTestDicom_h

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>

#include <stdexcept>
#include <string>

namespace bone
{
/** A DICOM image in another transfer syntax. */
inline void
TransferDicom(const std::string & from, gdcm::TransferSyntax::TSType syntax, const std::string & to)
{
  gdcm::ImageReader reader;
  reader.SetFileName(from.c_str());
  gdcm::ImageChangeTransferSyntax change;
  change.SetTransferSyntax(syntax);
  gdcm::ImageWriter writer;
  writer.SetFileName(to.c_str());
  bool done = reader.Read();
  change.SetInput(reader.GetImage());
  done = done && change.Change();
  writer.SetFile(reader.GetFile());
  writer.SetImage(change.GetOutput());
  if (!done || !writer.Write())
  {
    throw std::runtime_error("GDCM cannot write " + to);
  }
}
} // namespace bone

#endif
