/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVoxelFile.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace bone
{
namespace
{
constexpr std::size_t BlockSize = std::size_t{ 1 } << 20;
/** Bytes of the stream between two entries, at least. */
constexpr std::size_t EntryDistance = std::size_t{ 1 } << 21;
constexpr std::size_t WindowSize = std::size_t{ 1 } << 15;
/** No byte of a deflated stream stands for more. */
constexpr std::size_t LargestRatio = 1032;
} // namespace

VoxelFile::VoxelFile(VoxelPlace place)
  : m_Place(std::move(place))
  , m_File(m_Place.path, std::ios::binary)
{
  if (m_Place.compressed)
  {
    m_Input.resize(std::size_t{ 1 } << 18);
    m_Entries.push_back({ 0, m_Place.start, 0, {} });
  }
}

VoxelFile::~VoxelFile()
{
  if (m_Entered)
  {
    inflateEnd(&m_Stream);
  }
}

bool
VoxelFile::IsLongEnough() const
{
  std::error_code error;
  const auto      size = std::filesystem::file_size(m_Place.path, error);
  if (error || size < m_Place.start || m_Place.bytes == 0)
  {
    return false;
  }
  const std::size_t rest = size - m_Place.start;
  return m_Place.compressed ? m_Place.bytes / LargestRatio <= rest : m_Place.bytes + m_Place.skip <= rest;
}

void
VoxelFile::Enter(const Entry & entry)
{
  if (m_Entered)
  {
    inflateEnd(&m_Stream);
  }
  constexpr int anyHeader = 15 + 32, noHeader = -15;
  m_Headless = !entry.window.empty();
  m_Stream = {};
  m_Entered = inflateInit2(&m_Stream, m_Headless ? noHeader : anyHeader) == Z_OK;
  m_At = entry.to;
  m_Ended = false;
  m_InputEnd = entry.from - (entry.bits > 0 ? 1 : 0);
  m_File.clear();
  m_File.seekg(static_cast<std::streamoff>(m_InputEnd));
  m_Damaged = !m_Entered || !m_File;
  if (m_Damaged)
  {
    return;
  }
  if (entry.bits > 0)
  {
    const int byte = m_File.get();
    ++m_InputEnd;
    m_Damaged = byte < 0 || inflatePrime(&m_Stream, entry.bits, byte >> (8 - entry.bits)) != Z_OK;
  }
  if (m_Headless && !m_Damaged)
  {
    m_Damaged = inflateSetDictionary(&m_Stream, entry.window.data(), static_cast<uInt>(entry.window.size())) != Z_OK;
  }
}

void
VoxelFile::Fill()
{
  if (m_Stream.avail_in > 0) // before the first time there is no next_in
  {
    std::memmove(m_Input.data(), m_Stream.next_in, m_Stream.avail_in);
  }
  m_File.read(&m_Input[m_Stream.avail_in], static_cast<std::streamsize>(m_Input.size() - m_Stream.avail_in));
  m_Stream.avail_in += static_cast<uInt>(m_File.gcount());
  m_InputEnd += static_cast<std::size_t>(m_File.gcount());
  m_Stream.next_in = reinterpret_cast<Bytef *>(m_Input.data());
}

void
VoxelFile::FinishMember()
{
  if (m_Headless)
  {
    const auto next = std::find_if(m_Entries.begin(), m_Entries.end(), [this](const Entry & entry) {
      return entry.to == m_At && entry.window.empty();
    });
    m_Ended = next == m_Entries.end();
    if (!m_Ended)
    {
      this->Enter(*next);
    }
    return;
  }
  if (m_Stream.avail_in < 2)
  {
    this->Fill();
  }
  // What follows and is no member is passed over, as gzip does.
  m_Ended = !m_Place.mayGoOn || m_Stream.avail_in < 2 || m_Stream.next_in[0] != 0x1f || m_Stream.next_in[1] != 0x8b;
  if (!m_Ended)
  {
    m_Damaged = inflateReset(&m_Stream) != Z_OK;
    if (m_Noting)
    {
      m_Entries.push_back({ m_At, m_InputEnd - m_Stream.avail_in, 0, {} });
    }
  }
}

void
VoxelFile::NoteEntry()
{
  constexpr int betweenBlocks = 128, lastBlock = 64, bits = 7;
  if ((m_Stream.data_type & betweenBlocks) == 0 || (m_Stream.data_type & lastBlock) != 0 ||
      m_At < m_Entries.back().to + EntryDistance)
  {
    return;
  }
  Entry entry{ m_At, m_InputEnd - m_Stream.avail_in, m_Stream.data_type & bits, {} };
  uInt  size = WindowSize;
  entry.window.resize(size);
  if (inflateGetDictionary(&m_Stream, entry.window.data(), &size) == Z_OK && size > 0)
  {
    entry.window.resize(size);
    m_Entries.push_back(std::move(entry));
  }
}

std::size_t
VoxelFile::Inflate(char * to, std::size_t count)
{
  std::size_t done = 0;
  bool        stuck = false;
  while (done < count && !m_Ended && !m_Damaged)
  {
    const auto room = static_cast<uInt>(std::min(count - done, BlockSize));
    m_Stream.next_out = reinterpret_cast<Bytef *>(to + done);
    m_Stream.avail_out = room;
    if (m_Stream.avail_in == 0)
    {
      this->Fill();
    }
    const bool noMore = m_Stream.avail_in == 0;
    const int  state = inflate(&m_Stream, m_Noting ? Z_BLOCK : Z_NO_FLUSH);
    const auto made = static_cast<std::size_t>(room - m_Stream.avail_out);
    done += made;
    m_At += made;
    if (state == Z_STREAM_END)
    {
      this->FinishMember();
    }
    else if (state == Z_OK && m_Noting)
    {
      this->NoteEntry();
    }
    // zlib speaks of no progress also where bits that it had suffice for an empty block.
    m_Damaged = m_Damaged || (state != Z_OK && state != Z_STREAM_END && state != Z_BUF_ERROR) ||
                (state == Z_BUF_ERROR && noMore && stuck);
    stuck = state == Z_BUF_ERROR;
  }
  return done;
}

bool
VoxelFile::Skip(std::size_t count)
{
  std::vector<char> passed(std::min(count, BlockSize));
  while (count > 0)
  {
    const std::size_t made = this->Inflate(passed.data(), std::min(count, passed.size()));
    count -= made;
    if (made == 0)
    {
      return false;
    }
  }
  return true;
}

bool
VoxelFile::Scan(const std::function<void(const std::vector<char> & block)> & look)
{
  if (!m_Place.compressed && !look)
  {
    return this->IsLongEnough();
  }
  m_Noting = m_Place.compressed;
  if (m_Place.compressed)
  {
    m_Entries.resize(1);
    this->Enter(m_Entries.front());
  }
  std::vector<char> block(BlockSize);
  bool              whole = true;
  for (std::size_t done = 0; whole && done < m_Place.bytes; done += block.size())
  {
    block.resize(std::min(block.size(), m_Place.bytes - done));
    whole = this->Read(done, block.size(), block.data());
    if (whole && look)
    {
      look(block);
    }
  }
  whole = whole && this->EndsWell();
  m_Noting = false;
  return whole;
}

bool
VoxelFile::Read(std::size_t from, std::size_t count, char * to)
{
  if (!m_Place.compressed)
  {
    m_File.clear();
    m_File.seekg(static_cast<std::streamoff>(m_Place.start + m_Place.skip + from));
    m_File.read(to, static_cast<std::streamsize>(count));
    return m_File && static_cast<std::size_t>(m_File.gcount()) == count;
  }
  const std::size_t at = m_Place.skip + from;
  const auto        after = std::upper_bound(
    m_Entries.begin(), m_Entries.end(), at, [](std::size_t place, const Entry & entry) { return place < entry.to; });
  const Entry & entry = *std::prev(after);
  if (!m_Entered || m_Damaged || at < m_At || entry.to > m_At)
  {
    this->Enter(entry);
  }
  return this->Skip(at - m_At) && this->Inflate(to, count) == count;
}

bool
VoxelFile::EndsWell()
{
  if (!m_Place.compressed)
  {
    return true;
  }
  // More than a byte: a damaged stream may go on for some before it shows.
  std::vector<char> more(BlockSize);
  const bool        goesOn = this->Inflate(more.data(), more.size()) > 0;
  return !m_Damaged && (m_Place.mayGoOn || (!goesOn && m_Ended));
}
} // namespace bone
