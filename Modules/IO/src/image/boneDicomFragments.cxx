/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDicomFragments.h"

#include "boneRefuse.h"

#include <dcmtk/config/osconfig.h> // first of DCMTK's

#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace bone
{
namespace
{
struct FrameSize
{
  std::uint32_t rows{ 0 };
  std::uint32_t columns{ 0 };
  std::uint32_t samples{ 0 };
  std::uint32_t bits{ 0 }; ///< of a sample: stored at most
};

using Bytes = std::vector<std::uint8_t>;

std::uint32_t
BigEndian(const Bytes & bytes, std::size_t at, std::size_t count)
{
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    value = value << 8 | bytes[at + i];
  }
  return value;
}

/** What the frame header (SOF) of a JPEG or JPEG-LS codestream says. */
std::optional<FrameSize>
SizeOfJpeg(const Bytes & bytes)
{
  for (std::size_t at = 2; at + 10 <= bytes.size() && bytes[at] == 0xFF;)
  {
    const std::uint8_t marker = bytes[at + 1];
    const bool         table = marker == 0xC4 || marker == 0xC8 || marker == 0xCC;
    if ((marker >= 0xC0 && marker <= 0xCF && !table) || marker == 0xF7)
    {
      return FrameSize{ BigEndian(bytes, at + 5, 2), BigEndian(bytes, at + 7, 2), bytes[at + 9], bytes[at + 4] };
    }
    at += marker == 0xFF ? 1 : 2 + BigEndian(bytes, at + 2, 2);
  }
  return std::nullopt;
}

/** What the image and tile size (SIZ) of a JPEG 2000 codestream says. */
std::optional<FrameSize>
SizeOfJpeg2000(const Bytes & bytes)
{
  constexpr std::size_t head = 43; // SOC and SIZ with one component
  if (bytes.size() < head || BigEndian(bytes, 2, 2) != 0xFF51)
  {
    return std::nullopt;
  }
  const std::uint32_t right = BigEndian(bytes, 8, 4), bottom = BigEndian(bytes, 12, 4);
  const std::uint32_t left = BigEndian(bytes, 16, 4), top = BigEndian(bytes, 20, 4);
  return FrameSize{ bottom - top, right - left, BigEndian(bytes, 40, 2), (bytes[42] & 0x7Fu) + 1 };
}

/** Whether an RLE frame has a segment for each byte of a pixel, in their order, within it. */
bool
IsWholeRle(const Bytes & bytes, const FrameSize & needed)
{
  constexpr std::size_t head = 64;
  const auto            number = [&bytes](std::size_t at) {
    return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
  };
  const std::uint32_t segments = needed.samples * ((needed.bits + 7) / 8);
  if (bytes.size() < head || number(0) != segments || segments > 15)
  {
    return false;
  }
  std::uint32_t before = 0;
  for (std::uint32_t i = 0; i < segments; ++i)
  {
    const std::uint32_t from = number(4 + 4 * i);
    if (from < head || from <= before || from >= bytes.size())
    {
      return false;
    }
    before = from;
  }
  return true;
}

/** Whether a fragment that begins a codestream has the image's size; those that go on with one are true. */
bool
FitsImage(const Bytes & bytes, const FrameSize & needed, bool first)
{
  const std::uint32_t      mark = bytes.size() < 2 ? 0 : BigEndian(bytes, 0, 2);
  std::optional<FrameSize> found;
  if (mark == 0xFFD8)
  {
    found = SizeOfJpeg(bytes);
  }
  else if (mark == 0xFF4F)
  {
    found = SizeOfJpeg2000(bytes);
  }
  else
  {
    return !first;
  }
  return found && found->rows == needed.rows && found->columns == needed.columns && found->samples == needed.samples &&
         found->bits <= needed.bits;
}

FrameSize
SizeOfImage(DcmDataset & data)
{
  const auto number = [&data](const DcmTagKey & key) {
    Uint16 value = 1;
    data.findAndGetUint16(key, value);
    return static_cast<std::uint32_t>(value);
  };
  return { number(DCM_Rows), number(DCM_Columns), number(DCM_SamplesPerPixel), number(DCM_BitsAllocated) };
}

Bytes
BytesOf(DcmPixelSequence & sequence, unsigned long i)
{
  DcmPixelItem * item = nullptr;
  Uint8 *        bytes = nullptr;
  if (sequence.getItem(item, i).bad() || item->getUint8Array(bytes).bad() || bytes == nullptr)
  {
    return {};
  }
  return Bytes(bytes, bytes + item->getLength());
}
} // namespace

void
RequireWholeFragments(DcmDataset & data)
{
  const char * const damaged = "is a compressed DICOM image whose pixels are damaged or not all there; copy it again "
                               "from where it came";
  DcmElement *       element = nullptr;
  data.findAndGetElement(DCM_PixelData, element);
  auto *                             pixels = dynamic_cast<DcmPixelData *>(element);
  E_TransferSyntax                   syntax = EXS_Unknown;
  const DcmRepresentationParameter * parameter = nullptr;
  DcmPixelSequence *                 sequence = nullptr;
  if (pixels != nullptr)
  {
    pixels->getOriginalRepresentationKey(syntax, parameter);
  }
  if (pixels == nullptr || pixels->getEncapsulatedRepresentation(syntax, parameter, sequence).bad() ||
      sequence == nullptr || sequence->card() < 2 || BytesOf(*sequence, 0).size() % 4 != 0)
  {
    Refuse(damaged);
  }
  const FrameSize needed = SizeOfImage(data);
  for (unsigned long i = 1; i < sequence->card(); ++i) // after the table of offsets
  {
    const Bytes bytes = BytesOf(*sequence, i);
    if (!(syntax == EXS_RLELossless ? IsWholeRle(bytes, needed) : FitsImage(bytes, needed, i == 1)))
    {
      Refuse(damaged);
    }
  }
}
} // namespace bone
