/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomFile.h"

#include "boneDicomFragments.h"
#include "boneIOError.h"
#include "boneImageHeader.h"
#include "boneRefuse.h"

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dctk.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>

namespace bone
{
namespace
{
/** How many there are; DCMTK leaves 0 where the file does not say. */
int
FramesOf(DcmDataset & data)
{
  Sint32 frames = 1;
  return data.findAndGetSint32(DCM_NumberOfFrames, frames).good() ? frames : 1;
}

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
  return bytes / 8.0 * FramesOf(data);
}

/** Throws where GDCM would stop the program: more samples a pixel than colours have, or bits that are not there. */
void
RequireKnownPixels(DcmDataset & data, const std::string & path)
{
  const auto number = [&data](const DcmTagKey & key, int otherwise) {
    Uint16 value = 0;
    return data.findAndGetUint16(key, value).good() ? static_cast<int>(value) : otherwise;
  };
  const int samples = number(DCM_SamplesPerPixel, 1);
  const int allocated = number(DCM_BitsAllocated, 16);
  const int stored = number(DCM_BitsStored, allocated);
  const int high = number(DCM_HighBit, stored - 1);
  if (samples < 1 || samples > 4 || allocated < 1 || allocated > 64 || stored < 1 || stored > allocated || high < 0 ||
      high >= allocated)
  {
    throw IOError(path,
                  "is a DICOM file that is damaged: it says that pixels have " + std::to_string(samples) +
                    " samples, and " + std::to_string(stored) + " of " + std::to_string(allocated) + " bits");
  }
}

std::string
Text(DcmDataset & data, const DcmTagKey & key)
{
  OFString text;
  data.findAndGetOFStringArray(key, text);
  return text.c_str();
}

/** Whether the attribute has so many numbers, which are stored. */
template <std::size_t VCount>
bool
Numbers(DcmDataset & data, const DcmTagKey & key, std::array<double, VCount> & numbers)
{
  bool all = true;
  for (std::size_t i = 0; i < VCount; ++i)
  {
    all = all && data.findAndGetFloat64(key, numbers[i], static_cast<unsigned long>(i)).good();
  }
  return all;
}

void
ReadPlace(DcmDataset & data, DicomHeader & header)
{
  std::array<double, 6> axes{};
  header.placed =
    Numbers(data, DCM_ImagePositionPatient, header.position) && Numbers(data, DCM_ImageOrientationPatient, axes);
  for (std::size_t k = 0; k < 3; ++k)
  {
    const std::size_t i = (k + 1) % 3;
    const std::size_t j = (k + 2) % 3;
    header.normal[k] = axes[i] * axes[3 + j] - axes[j] * axes[3 + i];
  }
}
} // namespace

namespace
{
/** Whether the elements of group 2, which come first in the file, are whole: GDCM stops the program where they are not.
 */
bool
HasWholeMetaHeader(const std::string & path)
{
  constexpr std::uint16_t metaGroup = 2;
  constexpr std::uint32_t undefined = 0xFFFFFFFF;
  std::ifstream           stream(path, std::ios::binary);
  const auto              size = static_cast<std::uint64_t>(std::filesystem::file_size(path));
  std::uint64_t           at = 132; // after the preamble and its mark
  std::array<char, 8>     head{};
  while (stream.seekg(static_cast<std::streamoff>(at)) && stream.read(head.data(), head.size()))
  {
    if (Decode<std::uint16_t>(head.data(), false) != metaGroup)
    {
      return true;
    }
    static const std::set<std::string> longLength{ "OB", "OD", "OF", "OL", "OV", "OW",
                                                   "SV", "UC", "UN", "UR", "UT", "UV" };
    static const std::set<std::string> shortLength{ "AE", "AS", "AT", "CS", "DA", "DS", "DT", "FD", "FL", "IS", "LO",
                                                    "LT", "PN", "SH", "SL", "SS", "ST", "TM", "UI", "UL", "US" };
    const std::string                  kind(&head[4], 2);
    std::uint32_t                      length = Decode<std::uint16_t>(&head[6], false);
    at += head.size();
    if (longLength.count(kind) > 0)
    {
      std::array<char, 4> more{};
      stream.read(more.data(), more.size());
      length = Decode<std::uint32_t>(more.data(), false);
      at += more.size();
    }
    at += length;
    if (longLength.count(kind) + shortLength.count(kind) == 0 || length == undefined || at > size)
    {
      return false;
    }
  }
  return false;
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

DicomHeader
ReadWholeDicomFile(const std::string & path)
{
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);
  if (IsDicomFile(path) && !HasWholeMetaHeader(path))
  {
    throw IOError(path,
                  "is a DICOM file that is cut short or damaged, in its first part; copy it again from where it came");
  }
  // Files that were sent without types and then stored with them have "unknown" types for elements that are known.
  dcmEnableUnknownVRConversion.set(OFTrue);
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
  DicomHeader  header;
  header.image = data.findAndGetElement(DCM_PixelData, pixels).good();
  if (plain && header.image && pixels->getLength() < BytesOfPixels(data))
  {
    throw IOError(path, "is a DICOM image whose pixels are not all there; copy it again from where it came");
  }
  RequireKnownPixels(data, path);
  if (!plain && header.image)
  {
    NamingFile(path, [&data] { RequireWholeFragments(data); });
  }
  header.path = path;
  header.series = Text(data, DCM_SeriesInstanceUID);
  header.number = Text(data, DCM_SeriesNumber);
  header.description = Text(data, DCM_SeriesDescription);
  header.modality = Text(data, DCM_Modality);
  header.instance = Text(data, DCM_SOPInstanceUID);
  header.scout = Text(data, DCM_ImageType).find("LOCALIZER") != std::string::npos;
  Uint16 rows = 0;
  Uint16 columns = 0;
  data.findAndGetUint16(DCM_Rows, rows);
  data.findAndGetUint16(DCM_Columns, columns);
  header.rows = rows;
  header.columns = columns;
  header.frames = FramesOf(data);
  ReadPlace(data, header);
  return header;
}
} // namespace bone
