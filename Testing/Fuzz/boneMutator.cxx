/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMutator.h"

#include <itk_zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace bone
{
namespace
{
constexpr int GzipWindow = 15 + 16;

template <typename T>
void
Overwrite(std::string & bytes, std::size_t at, T value)
{
  std::memcpy(&bytes[at], &value, std::min(sizeof(T), bytes.size() - at));
}

const char * const WildWords[] = {
  "1e300",  "-1e300", "nan",  "inf",  "-1", "0",     "4294967296", "99999999999999999999",
  "1e-300", "0x10",   "<a>",  "]]",   "[[", "{",     "\"",         "\n",
  "%d",     ",",      "LIST", "true", "\\", "null,", "../",        "1e9"
};
} // namespace

std::string
Compress(const std::string & bytes)
{
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, GzipWindow, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, static_cast<uLong>(bytes.size())) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef *>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string
Decompress(const std::string & gzip)
{
  z_stream stream{};
  if (inflateInit2(&stream, GzipWindow) != Z_OK)
  {
    return "";
  }
  std::string out;
  stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  for (int state = Z_OK; state == Z_OK;)
  {
    char block[65536];
    stream.next_out = reinterpret_cast<Bytef *>(block);
    stream.avail_out = sizeof block;
    state = inflate(&stream, Z_NO_FLUSH);
    out.append(block, sizeof block - stream.avail_out);
  }
  inflateEnd(&stream);
  return out;
}

void
Mutator::DamageOnce(std::string & bytes)
{
  if (bytes.empty())
  {
    bytes = "x";
  }
  // Headers come first in most formats, and are what readers believe.
  const std::size_t reach = Below(2) == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 512);
  const std::size_t at = Below(reach);
  const std::size_t length = 1 + Below(std::min<std::size_t>(bytes.size() - at, Below(4) == 0 ? 4096 : 16));
  switch (Below(10))
  {
    case 0:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << Below(8)));
      return;
    case 1:
      bytes[at] = "\0\xff\x7f\x80-9.e "[Below(9)];
      return;
    case 2:
    {
      const std::int32_t values[] = {
        0, -1, 1, std::numeric_limits<int>::max(), std::numeric_limits<int>::min(), 65536
      };
      Overwrite(bytes, at, values[Below(6)]);
      return;
    }
    case 3:
    {
      const float values[] = {
        0.0F, -1.0F, 3e38F, 1e-38F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()
      };
      Overwrite(bytes, at, values[Below(6)]);
      return;
    }
    case 4:
    {
      const double values[] = {
        0.0, -1.0, 1e300, 1e-300, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()
      };
      Overwrite(bytes, at, values[Below(6)]);
      return;
    }
    case 5:
      bytes.erase(at, length);
      return;
    case 6:
      bytes.insert(at, bytes.substr(at, length));
      return;
    case 7:
      bytes.resize(at);
      return;
    case 8:
      bytes.insert(at, WildWords[Below(std::size(WildWords))]);
      return;
    default:
    {
      // A number in a text becomes another.
      const std::size_t digit = bytes.find_first_of("0123456789", at);
      if (digit != std::string::npos)
      {
        const std::size_t end = std::min(bytes.find_first_not_of("0123456789.", digit), bytes.size());
        bytes.replace(digit, end - digit, WildWords[Below(std::size(WildWords))]);
      }
    }
  }
}

std::string
Mutator::Damage(const std::string & bytes)
{
  std::string damaged = bytes;
  for (std::size_t times = 1 + Below(2) * Below(4); times > 0; --times) // mostly once, as more is mostly refused
  {
    DamageOnce(damaged);
  }
  return damaged;
}

void
Mutator::DamageBase64(std::string & bytes)
{
  constexpr std::size_t shortest = 40; // of an array's text
  const std::string     letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (int attempt = 0; attempt < 1000; ++attempt)
  {
    const std::size_t at = Below(bytes.size());
    const std::size_t before = bytes.find_last_of("<>", at);
    const std::size_t after = bytes.find_first_of("<>", at);
    if (before != std::string::npos && bytes[before] == '>' && after != std::string::npos &&
        after - before > shortest && letters.find(bytes[at]) != std::string::npos)
    {
      bytes[at] = letters[Below(letters.size())];
      return;
    }
  }
}

std::string
Mutator::DamagePayload(const std::string & bytes, Payload payload)
{
  constexpr std::size_t longestHeader = 400; // of the seeds
  std::string           damaged = bytes;
  const std::size_t     first = std::min(longestHeader, bytes.size() / 2);
  const std::size_t     at = first + Below(bytes.size() - first);
  if (payload == Payload::Length || Below(4) == 0)
  {
    damaged.resize(at);
  }
  else if (payload == Payload::Base64)
  {
    this->DamageBase64(damaged);
  }
  else
  {
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << Below(8)));
  }
  return damaged;
}

std::string
Mutator::DamageWithin(const std::string & gzip)
{
  return Compress(Damage(Decompress(gzip)));
}
} // namespace bone
