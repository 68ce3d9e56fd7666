/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageCheck.h"

#include "boneGzFile.h"
#include "boneImageHeader.h"
#include "boneVtkFile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <vector>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

// What is needed of a NIfTI-1 header (348 bytes; offsets as in nifti1.h).
struct NiftiHeader
{
  bool        readable{ false };
  bool        valid{ false };
  bool        swapped{ false };
  bool        single{ false }; // header and data in one file
  bool        analyze{ true }; // no NIfTI file, but one of Analyze 7.5
  int         datatype{ 0 };
  std::size_t voxels{ 1 };
  std::size_t bytes{ 0 };
  std::size_t offset{ 0 };
  double      slope{ 0.0 };
  double      intercept{ 0.0 };
};

NiftiHeader
ReadNiftiHeader(const std::string & path)
{
  NiftiHeader           header;
  std::array<char, 348> raw;
  const GzFile          file = OpenGz(path);
  if (!file || gzread(file.get(), raw.data(), raw.size()) != static_cast<int>(raw.size()))
  {
    return header; // a small file is decompressed whole, with its checksum, before the first byte comes
  }
  header.readable = true;
  const auto dimensions = Decode<std::int16_t>(&raw[40], false);
  header.swapped = dimensions < 1 || dimensions > 7;
  header.valid = Decode<std::int32_t>(&raw[0], header.swapped) == 348;
  const int n = Decode<std::int16_t>(&raw[40], header.swapped);
  for (int d = 1; d <= std::min(n, 7); ++d)
  {
    header.voxels *= static_cast<std::size_t>(std::max<int>(1, Decode<std::int16_t>(&raw[40 + 2 * d], header.swapped)));
  }
  header.datatype = Decode<std::int16_t>(&raw[70], header.swapped);
  header.bytes = header.voxels * static_cast<std::size_t>(Decode<std::int16_t>(&raw[72], header.swapped)) / 8;
  header.offset = static_cast<std::size_t>(std::max(0.0f, Decode<float>(&raw[108], header.swapped)));
  header.slope = Decode<float>(&raw[112], header.swapped);
  header.intercept = Decode<float>(&raw[116], header.swapped);
  header.single = std::memcmp(&raw[344], "n+1", 3) == 0;
  header.analyze = !header.single && std::memcmp(&raw[344], "ni1", 3) != 0;
  return header;
}

// The file of a pair that ends in .hdr or .img, plain or compressed; the path itself where there is none.
std::string
PairMember(const std::string & path, const std::string & extension)
{
  std::string stem = path;
  for (const char * ending : { ".gz", ".hdr", ".img" })
  {
    stem = HasExtension(stem, ending) ? stem.substr(0, stem.size() - std::strlen(ending)) : stem;
  }
  for (const std::string & candidate : { stem + extension, stem + extension + ".gz" })
  {
    std::error_code error;
    if (fs::exists(candidate, error))
    {
      return candidate;
    }
  }
  return path;
}

template <typename T>
void
CountNotFinite(const std::vector<char> & block, bool swapped, std::size_t before, VoxelCheck & check)
{
  for (std::size_t i = 0; i + sizeof(T) <= block.size(); i += sizeof(T))
  {
    if (!std::isfinite(Decode<T>(&block[i], swapped)) && check.notFinite++ == 0)
    {
      check.firstNotFinite = (before + i) / sizeof(T);
    }
  }
}

/** The type of NIfTI's code; unknown where it is none of one number. */
itk::IOComponentEnum
NiftiComponent(int datatype)
{
  using Type = itk::IOComponentEnum;
  static const std::map<int, Type> types{ { 2, Type::UCHAR },       { 4, Type::SHORT },   { 8, Type::INT },
                                          { 16, Type::FLOAT },      { 64, Type::DOUBLE }, { 256, Type::CHAR },
                                          { 512, Type::USHORT },    { 768, Type::UINT },  { 1024, Type::LONGLONG },
                                          { 1280, Type::ULONGLONG } };
  const auto                       found = types.find(datatype);
  return found == types.end() ? Type::UNKNOWNCOMPONENTTYPE : found->second;
}

bool
IsGzip(const std::string & path)
{
  std::ifstream file(path, std::ios::binary);
  const int     first = file.get();
  return first == 0x1f && file.get() == 0x8b;
}

/** Whether and how ITK scales what is read, by the type that it says it reads; not plain where that cannot be told. */
void
SetScale(const NiftiHeader & header, const itk::ImageIOBase * io, ImageVoxels & voxels)
{
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  using Type = itk::IOComponentEnum;
  voxels.slope = std::abs(header.slope) < epsilon ? 1.0 : header.slope;
  voxels.intercept = header.intercept;
  voxels.rescaled = std::abs(voxels.slope - 1.0) > epsilon || std::abs(voxels.intercept) > epsilon;
  const Type type = io->GetComponentType();
  const bool whole = voxels.component != Type::FLOAT && voxels.component != Type::DOUBLE;
  voxels.plain = voxels.plain && (whole ? (type == Type::FLOAT) == voxels.rescaled : type == voxels.component);
}

ImageVoxels
FindNiftiVoxels(const std::string & path, const itk::ImageIOBase * io)
{
  constexpr std::size_t headerSize = 348;
  ImageVoxels           voxels;
  const bool pair = HasExtension(path, ".img") || HasExtension(path, ".img.gz") || HasExtension(path, ".hdr") ||
                    HasExtension(path, ".hdr.gz");
  const NiftiHeader header = ReadNiftiHeader(pair ? PairMember(path, ".hdr") : path);
  voxels.known = header.valid || !header.readable;
  voxels.whole = header.readable;
  if (!header.valid)
  {
    return voxels;
  }
  VoxelPlace        place{ header.single ? path : PairMember(path, ".img") };
  const std::size_t offset = header.single ? std::max(header.offset, headerSize) : header.offset;
  place.compressed = IsGzip(place.path);
  (place.compressed ? place.skip : place.start) = offset;
  place.bytes = header.bytes;
  place.mayGoOn = true;
  voxels.component = NiftiComponent(header.datatype);
  voxels.swapped = header.swapped;
  voxels.plain = !header.analyze && voxels.component != itk::IOComponentEnum::UNKNOWNCOMPONENTTYPE;
  SetScale(header, io, voxels);
  voxels.place = std::move(place);
  return voxels;
}

/** Whether the names that follow are those of files, and there are some. */
bool
ListedFilesExist(std::istream & names, const fs::path & folder)
{
  std::size_t count = 0;
  for (std::string line; std::getline(names, line);)
  {
    std::error_code error;
    if (!Trim(line).empty() && !fs::is_regular_file(folder / Trim(line), error))
    {
      return false;
    }
    count += Trim(line).empty() ? 0 : 1;
  }
  return count > 0;
}

/** "name%03d.raw first last step": without its numbers MetaIO divides by nothing. */
bool
IsFilePattern(const std::string & data)
{
  std::istringstream text(data);
  std::string        name;
  long               first = 0, last = 0, step = 0;
  return text >> name >> first >> last >> step && first >= 0 && last >= first && step > 0;
}

bool
IsTrue(const std::string & text)
{
  return !text.empty() && (text[0] == 'T' || text[0] == 't');
}

ImageVoxels
FindMetaVoxels(const std::string & path, const itk::ImageIOBase * io)
{
  ImageVoxels       voxels;
  std::ifstream     stream(path, std::ios::binary);
  auto              fields = ReadMetaHeader(stream);
  const std::string data = fields["ElementDataFile"];
  if (data.rfind("LIST", 0) == 0 || data.find('%') != std::string::npos)
  {
    voxels.known = true;
    voxels.whole = data[0] == 'L' ? ListedFilesExist(stream, fs::path(path).parent_path()) : IsFilePattern(data);
    return voxels;
  }
  if (!stream || !IsTrue(fields["BinaryData"]))
  {
    return voxels;
  }
  voxels.known = true;
  const bool local = data == "LOCAL" || data == "Local" || data == "local";
  VoxelPlace place{ local ? path : (fs::path(path).parent_path() / data).string() };
  place.start = local ? static_cast<std::size_t>(stream.tellg()) : 0;
  place.bytes = static_cast<std::size_t>(io->GetImageSizeInBytes());
  place.compressed = IsTrue(fields["CompressedData"]);
  // MetaIO asks for as much memory as the header says that the compressed data need; 0 where it does not say.
  std::error_code error;
  const auto      size = fs::file_size(place.path, error);
  const double    compressed = std::strtod(fields["CompressedDataSize"].c_str(), nullptr);
  voxels.whole = !error && compressed >= 0.0 && compressed <= static_cast<double>(size);
  const bool twoOrders = fields.count("BinaryDataByteOrderMSB") > 0 && fields.count("ElementByteOrderMSB") > 0;
  voxels.plain = fields.count("HeaderSize") == 0 && !twoOrders;
  voxels.swapped = IsTrue(fields["BinaryDataByteOrderMSB"] + fields["ElementByteOrderMSB"]);
  voxels.component = io->GetComponentType();
  voxels.place = std::move(place);
  return voxels;
}

/** Data in one file, raw or gzip. */
ImageVoxels
FindNrrdVoxels(const std::string & path, const itk::ImageIOBase * io)
{
  ImageVoxels       voxels;
  std::ifstream     stream(path, std::ios::binary);
  auto              fields = ReadNrrdHeader(stream);
  const std::string data = fields["data file"] + fields["datafile"], encoding = fields["encoding"];
  const bool        skips =
    fields.count("line skip") + fields.count("lineskip") + fields.count("byte skip") + fields.count("byteskip") > 0;
  const bool gzip = encoding == "gzip" || encoding == "gz";
  if (skips || (!gzip && encoding != "raw") || data.find('%') != std::string::npos || data.rfind("LIST", 0) == 0 ||
      (data.empty() && !stream))
  {
    return voxels;
  }
  voxels.known = true;
  VoxelPlace place{ data.empty() ? path : (fs::path(path).parent_path() / data).string() };
  place.start = data.empty() ? static_cast<std::size_t>(stream.tellg()) : 0;
  place.bytes = static_cast<std::size_t>(io->GetImageSizeInBytes());
  place.compressed = gzip;
  const std::string endian = fields["endian"];
  voxels.plain = fields["dimension"] == "3" && (endian == "little" || endian == "big" || io->GetComponentSize() == 1);
  voxels.swapped = endian == "big";
  voxels.component = io->GetComponentType();
  voxels.place = std::move(place);
  return voxels;
}
} // namespace

ImageVoxels
FindVoxels(const std::string & path, const itk::ImageIOBase * io)
{
  const std::string format = io->GetNameOfClass();
  ImageVoxels       voxels = format == "NiftiImageIO"  ? FindNiftiVoxels(path, io)
                             : format == "MetaImageIO" ? FindMetaVoxels(path, io)
                             : format == "NrrdImageIO" ? FindNrrdVoxels(path, io)
                                                       : ImageVoxels();
  voxels.plain = voxels.plain && io->GetNumberOfComponents() == 1;
  return voxels;
}

VoxelCheck
CheckVoxels(const ImageVoxels & voxels, VoxelFile & file)
{
  VoxelCheck  check;
  std::size_t done = 0;
  const auto  count = [&](const std::vector<char> & block) {
    if (voxels.component == itk::IOComponentEnum::FLOAT)
    {
      CountNotFinite<float>(block, voxels.swapped, done, check);
    }
    else
    {
      CountNotFinite<double>(block, voxels.swapped, done, check);
    }
    done += block.size();
  };
  const bool mayBeNotFinite =
    voxels.component == itk::IOComponentEnum::FLOAT || voxels.component == itk::IOComponentEnum::DOUBLE;
  check.whole = file.IsLongEnough() &&
                (mayBeNotFinite ? file.Scan(count) : file.Scan(std::function<void(const std::vector<char> &)>()));
  return check;
}
} // namespace bone
