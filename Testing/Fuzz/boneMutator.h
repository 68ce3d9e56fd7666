/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMutator_h
#define boneMutator_h

#include <cstdint>
#include <random>
#include <string>

namespace bone
{
/** What of a format's payload a reader has to notice: nothing; that the end is missing; damage anywhere, by a checksum;
 * the same in the compressed arrays of VTK's XML, which are written in base64. */
enum class Payload
{
  Unchecked,
  Length,
  Compressed,
  Base64
};

/** \class Mutator
 * \brief Damages a file's bytes: flipped bits, wild numbers and words, ranges cut out, doubled or moved, the end cut
 * off.
 *
 * The same seed gives the same damage. Compressed text (gzip) may be damaged within, so that readers get to see it. */
class Mutator
{
public:
  explicit Mutator(std::uint64_t seed)
    : m_Random(seed)
  {}

  std::string
  Damage(const std::string & bytes);

  /** The same in the content of a gzip file. */
  std::string
  DamageWithin(const std::string & gzip);

  /** Damage that a reader has to notice: behind the header, in what is checked. */
  std::string
  DamagePayload(const std::string & bytes, Payload payload);

  /** A number below `count`. */
  std::size_t
  Below(std::size_t count)
  {
    return count == 0 ? 0 : static_cast<std::size_t>(m_Random() % count);
  }

private:
  void
  DamageOnce(std::string & bytes);
  void
  DamageBase64(std::string & bytes);

  std::mt19937_64 m_Random;
};

/** zlib's gzip of the bytes, and back; empty where they are none. */
std::string
Compress(const std::string & bytes);
std::string
Decompress(const std::string & gzip);
} // namespace bone

#endif
