/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneXmlCheck.h"

#include "boneIOError.h"
#include "boneImageHeader.h"
#include "boneRefuse.h"

#include <vtkNew.h>
#include <vtkXMLParser.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>

namespace bone
{
namespace
{
/** What a byte may become: zlib's limit. The other compressors of VTK stay below it but for arrays of one value. */
constexpr double MostOfByte = 1032.0;

/** Bytes that base64 stands for; up to the first other sign. */
std::string
DecodeBase64(const std::string & text)
{
  static const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string              bytes;
  unsigned int             bits = 0;
  int                      count = 0;
  for (const char c : text)
  {
    const auto value = letters.find(c);
    if (value == std::string::npos)
    {
      break;
    }
    bits = bits << 6 | static_cast<unsigned int>(value);
    count += 6;
    if (count >= 8)
    {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 0xFF);
    }
  }
  return bytes;
}

class SoundnessParser : public vtkXMLParser
{
public:
  vtkTypeMacro(SoundnessParser, vtkXMLParser);
  static constexpr int Deepest = 100; ///< files of VTK and RTK have eight levels

  static SoundnessParser *
  New()
  {
    auto * parser = new SoundnessParser;
    parser->InitializeObjectBase();
    return parser;
  }
  void
  SetSize(double bytes)
  {
    m_Size = bytes;
  }
  const std::string &
  GetProblem() const
  {
    return m_Problem;
  }

protected:
  void
  StartElement(const char * name, const char ** attributes) override
  {
    if (++m_Depth > Deepest)
    {
      this->Refuse(Say("has elements nested more than ", Deepest, " levels deep"));
    }
    if (std::strcmp(name, "DataArray") == 0)
    {
      m_Array = m_Depth; // within, there may be elements on it
      m_Binary = false;
      m_Text.clear();
      m_Letters = 0.0;
    }
    m_Entries = std::strcmp(name, "Piece") == 0 ? 0.0 : m_Entries;
    for (; attributes[0] != nullptr && attributes[1] != nullptr; attributes += 2)
    {
      this->TakeAttribute(name, attributes[0], attributes[1]);
    }
  }
  void
  EndElement(const char *) override
  {
    if (m_Depth == m_Array && m_Binary)
    {
      this->CheckBinary();
    }
    m_Array = m_Depth == m_Array ? NoDepth : m_Array;
    --m_Depth;
  }
  void
  CharacterDataHandler(const char * text, int length) override
  {
    for (int i = 0; m_Depth == m_Array && i < length; ++i)
    {
      if (static_cast<unsigned char>(text[i]) > ' ')
      {
        m_Letters += 1.0;
        if (m_Text.size() < LongestHeader)
        {
          m_Text += text[i];
        }
      }
    }
  }
  int
  ParsingComplete() override
  {
    return m_Problem.empty() ? vtkXMLParser::ParsingComplete() : 1;
  }

private:
  static constexpr std::size_t LongestHeader = std::size_t{ 1 } << 20;
  static constexpr int         NoDepth = -1;

  void
  Refuse(const std::string & problem)
  {
    m_Problem = m_Problem.empty() ? problem : m_Problem;
  }

  void
  TakeAttribute(const char * element, const std::string & name, const std::string & value)
  {
    constexpr double mostComponents = 1000.0; // a density of degree 8 has 165
    m_WordSize = name == "header_type" ? (value == "UInt64" ? 8 : 4) : m_WordSize;
    m_BigEndian = name == "byte_order" ? value == "BigEndian" : m_BigEndian;
    m_Compressed = m_Compressed || (name == "compressor" && !value.empty());
    m_Binary = m_Binary || (name == "format" && value == "binary");
    const bool components = name == "NumberOfComponents" || name == "length"; // that of a list of numbers on an array
    if (!components && name.rfind("NumberOf", 0) != 0)
    {
      return;
    }
    double     number = -1.0;
    const auto parsed = std::from_chars(value.data(), value.data() + value.size(), number);
    const bool whole = parsed.ec == std::errc() && parsed.ptr == value.data() + value.size() && number >= 0.0 &&
                       number == std::floor(number);
    m_Entries = components ? m_Entries : std::max(m_Entries, number);
    if (!whole || (components && number > mostComponents) ||
        (components ? number * m_Entries : number) * sizeof(double) > m_Size * MostOfByte)
    {
      this->Refuse(Say("is damaged: '", name, "' of '", element, "' is ", value.substr(0, 40)));
    }
  }

  double
  Word(const std::string & bytes, std::size_t index) const
  {
    const char * at = &bytes[index * m_WordSize];
    return m_WordSize == 8 ? static_cast<double>(Decode<std::uint64_t>(at, m_BigEndian))
                           : static_cast<double>(Decode<std::uint32_t>(at, m_BigEndian));
  }

  /** An array is its number of bytes and these, or, compressed, the number, size and last size of blocks, the sizes
   * when compressed, and the blocks. */
  void
  CheckBinary()
  {
    const std::string header = DecodeBase64(m_Text);
    const double      stored = 0.75 * m_Letters;
    const std::size_t words = header.size() / m_WordSize;
    if (words < (m_Compressed ? 3 : 1))
    {
      return; // nothing is read of it
    }
    double size = this->Word(header, 0);
    if (m_Compressed)
    {
      const double blocks = size;
      const double block = this->Word(header, 1);
      size = blocks * static_cast<double>(m_WordSize);
      for (std::size_t i = 0; i < words - 3 && static_cast<double>(i) < blocks; ++i)
      {
        size += this->Word(header, 3 + i);
      }
      const double last = this->Word(header, 2);
      const double plain = last > 0.0 && blocks > 0.0 ? (blocks - 1.0) * block + last : blocks * block;
      if (!(plain <= MostOfByte * stored) || (blocks > 0.0 && !(block > 0.0))) // VTK divides by the block's size
      {
        this->Refuse("is damaged: an array holds more than its bytes can be decompressed to");
      }
    }
    if (!(size <= stored))
    {
      this->Refuse("is cut short or damaged: an array is shorter than it says");
    }
  }

  std::string m_Problem;
  std::string m_Text; ///< of the array, without blanks, its start
  double      m_Letters{ 0.0 };
  double      m_Size{ 0.0 };    ///< of the file
  double      m_Entries{ 0.0 }; ///< the most that an array of the piece may have
  std::size_t m_WordSize{ 4 };
  int         m_Depth{ 0 };
  int         m_Array{ NoDepth }; ///< depth of the array
  bool        m_Binary{ false };
  bool        m_Compressed{ false };
  bool        m_BigEndian{ false };
};
} // namespace

void
RequireSoundXml(const std::string & path)
{
  std::error_code         error;
  vtkNew<SoundnessParser> parser;
  parser->SetSize(static_cast<double>(std::filesystem::file_size(path, error)));
  parser->SetFileName(path.c_str());
  parser->Parse();
  if (!parser->GetProblem().empty())
  {
    throw IOError(path, parser->GetProblem());
  }
}
} // namespace bone
