/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomFile.h"

#include "boneIOError.h"

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dctk.h>

#include <fstream>

namespace bone
{
namespace
{
/** Bytes that the pixels of an image need without compression; 0 where the file does not say. */
double
BytesOfPixels(DcmDataset & data)
{
  double bytes = 1.0;
  for (const DcmTagKey & key : { DCM_Rows, DCM_Columns, DCM_SamplesPerPixel, DCM_BitsAllocated })
  {
    Uint16 value = 0;
    data.findAndGetUint16(key, value);
    bytes *= value;
  }
  Sint32 frames = 1;
  data.findAndGetSint32(DCM_NumberOfFrames, frames);
  return bytes / 8.0 * frames;
}
} // namespace

bool
IsDicomFile(const std::string & path)
{
  std::ifstream stream(path, std::ios::binary);
  char          mark[4] = {};
  stream.seekg(128);
  stream.read(mark, 4);
  return stream.good() && std::string(mark, 4) == "DICM";
}

void
RequireWholeDicomFile(const std::string & path)
{
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);
  DcmFileFormat     file;
  const OFCondition read = file.loadFile(path.c_str());
  if (read.bad())
  {
    throw IOError(path,
                  std::string("is a DICOM file that is cut short or damaged (") + read.text() +
                    "); copy it again from where it came");
  }
  DcmDataset & data = *file.getDataset();
  DcmElement * pixels = nullptr;
  const bool   plain = !DcmXfer(data.getOriginalXfer()).isEncapsulated();
  if (plain && data.findAndGetElement(DCM_PixelData, pixels).good() && pixels->getLength() < BytesOfPixels(data))
  {
    throw IOError(path, "is a DICOM image whose pixels are not all there; copy it again from where it came");
  }
}
} // namespace bone
