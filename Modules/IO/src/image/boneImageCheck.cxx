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
  int         datatype{ 0 };
  std::size_t voxels{ 1 };
  std::size_t bytes{ 0 };
  std::size_t offset{ 0 };
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
  header.single = std::memcmp(&raw[344], "n+1", 3) == 0;
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
CountNotFinite(const std::vector<char> & block, bool swapped, std::size_t before, ImageFileCheck & check)
{
  for (std::size_t i = 0; i + sizeof(T) <= block.size(); i += sizeof(T))
  {
    if (!std::isfinite(Decode<T>(&block[i], swapped)) && check.notFinite++ == 0)
    {
      check.firstNotFinite = (before + i) / sizeof(T);
    }
  }
}

// Whether the compressed stream ends as it must, so that its checksum was compared too.
bool
EndsWell(gzFile file)
{
  char      more = 0;
  int       error = Z_OK;
  const int read = gzread(file, &more, 1);
  gzerror(file, &error);
  return read >= 0 && error != Z_BUF_ERROR;
}

ImageFileCheck
CheckNifti(const std::string & path)
{
  constexpr int  floatType = 16, doubleType = 64;
  ImageFileCheck check;
  const bool     pair = HasExtension(path, ".img") || HasExtension(path, ".img.gz") || HasExtension(path, ".hdr") ||
                    HasExtension(path, ".hdr.gz");
  const NiftiHeader header = ReadNiftiHeader(pair ? PairMember(path, ".hdr") : path);
  check.known = header.valid || !header.readable;
  check.whole = header.readable;
  if (!header.valid)
  {
    return check;
  }
  const GzFile      file = OpenGz(header.single ? path : PairMember(path, ".img"));
  std::vector<char> block(std::size_t{ 1 } << 20);
  check.whole = file != nullptr && gzseek(file.get(), static_cast<z_off_t>(header.offset), SEEK_SET) >= 0;
  for (std::size_t done = 0; check.whole && done < header.bytes; done += block.size())
  {
    block.resize(std::min(block.size(), header.bytes - done));
    check.whole =
      gzread(file.get(), block.data(), static_cast<unsigned int>(block.size())) == static_cast<int>(block.size());
    if (check.whole && header.datatype == floatType)
    {
      CountNotFinite<float>(block, header.swapped, done, check);
    }
    if (check.whole && header.datatype == doubleType)
    {
      CountNotFinite<double>(block, header.swapped, done, check);
    }
  }
  check.whole = check.whole && EndsWell(file.get());
  return check;
}

/** Whether a file's bytes from `offset` on are one stream of zlib or gzip that ends, with its checksum, after
 * `numberOfBytes`. */
bool
Inflates(const fs::path & path, std::size_t offset, std::size_t numberOfBytes)
{
  constexpr int     anyHeader = 15 + 32;
  std::ifstream     file(path, std::ios::binary);
  std::vector<char> from(std::size_t{ 1 } << 18), to(std::size_t{ 1 } << 20);
  file.seekg(static_cast<std::streamoff>(offset));
  z_stream stream{};
  if (!file || inflateInit2(&stream, anyHeader) != Z_OK)
  {
    return false;
  }
  int         state = Z_OK;
  std::size_t bytes = 0;
  while (state == Z_OK && bytes <= numberOfBytes)
  {
    if (stream.avail_in == 0)
    {
      file.read(from.data(), static_cast<std::streamsize>(from.size()));
      stream.next_in = reinterpret_cast<Bytef *>(from.data());
      stream.avail_in = static_cast<uInt>(file.gcount());
    }
    stream.next_out = reinterpret_cast<Bytef *>(to.data());
    stream.avail_out = static_cast<uInt>(to.size());
    state = inflate(&stream, Z_NO_FLUSH); // Z_BUF_ERROR where the file has no more
    bytes += to.size() - stream.avail_out;
  }
  inflateEnd(&stream);
  return state == Z_STREAM_END && bytes == numberOfBytes;
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

ImageFileCheck
CheckMetaImage(const std::string & path, std::size_t numberOfBytes)
{
  ImageFileCheck    check;
  std::ifstream     stream(path, std::ios::binary);
  auto              fields = ReadMetaHeader(stream);
  const std::string data = fields["ElementDataFile"];
  const auto isTrue = [](const std::string & text) { return !text.empty() && (text[0] == 'T' || text[0] == 't'); };
  if (data.rfind("LIST", 0) == 0 || data.find('%') != std::string::npos)
  {
    check.known = true;
    check.whole = data[0] == 'L' ? ListedFilesExist(stream, fs::path(path).parent_path()) : IsFilePattern(data);
    return check;
  }
  if (!stream || !isTrue(fields["BinaryData"]))
  {
    return check;
  }
  check.known = true;
  const bool      local = data == "LOCAL" || data == "Local" || data == "local";
  const auto      start = local ? static_cast<std::size_t>(stream.tellg()) : 0;
  const fs::path  file = local ? fs::path(path) : fs::path(path).parent_path() / data;
  std::error_code error;
  const auto      size = fs::file_size(file, error);
  // MetaIO asks for as much memory as the header says that the compressed data need; 0 where it does not say.
  const double compressed = std::strtod(fields["CompressedDataSize"].c_str(), nullptr);
  check.whole = !error && numberOfBytes > 0 && compressed >= 0.0 && compressed <= static_cast<double>(size);
  if (check.whole)
  {
    check.whole =
      isTrue(fields["CompressedData"]) ? Inflates(file, start, numberOfBytes) : size >= start + numberOfBytes;
  }
  return check;
}

/** Data in one file, raw or gzip. */
ImageFileCheck
CheckNrrd(const std::string & path, std::size_t numberOfBytes)
{
  ImageFileCheck    check;
  std::ifstream     stream(path, std::ios::binary);
  auto              fields = ReadNrrdHeader(stream);
  const std::string data = fields["data file"] + fields["datafile"], encoding = fields["encoding"];
  const bool        skips =
    fields.count("line skip") + fields.count("lineskip") + fields.count("byte skip") + fields.count("byteskip") > 0;
  const bool gzip = encoding == "gzip" || encoding == "gz";
  if (skips || (!gzip && encoding != "raw") || data.find('%') != std::string::npos || data.rfind("LIST", 0) == 0 ||
      (data.empty() && !stream))
  {
    return check;
  }
  check.known = true;
  const fs::path    file = data.empty() ? fs::path(path) : fs::path(path).parent_path() / data;
  const std::size_t start = data.empty() ? static_cast<std::size_t>(stream.tellg()) : 0;
  std::error_code   error;
  const auto        size = fs::file_size(file, error);
  check.whole =
    !error && numberOfBytes > 0 && (gzip ? Inflates(file, start, numberOfBytes) : size >= start + numberOfBytes);
  return check;
}
} // namespace

ImageFileCheck
CheckImageFile(const std::string & path, const itk::ImageIOBase * io)
{
  const std::string format = io->GetNameOfClass();
  if (format == "NiftiImageIO")
  {
    return CheckNifti(path);
  }
  if (format == "MetaImageIO")
  {
    return CheckMetaImage(path, static_cast<std::size_t>(io->GetImageSizeInBytes()));
  }
  if (format == "NrrdImageIO")
  {
    return CheckNrrd(path, static_cast<std::size_t>(io->GetImageSizeInBytes()));
  }
  return {};
}
} // namespace bone
