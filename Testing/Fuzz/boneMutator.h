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

  /** A number below `count`. */
  std::size_t
  Below(std::size_t count)
  {
    return count == 0 ? 0 : static_cast<std::size_t>(m_Random() % count);
  }

private:
  void
  DamageOnce(std::string & bytes);

  std::mt19937_64 m_Random;
};

/** zlib's gzip of the bytes, and back; empty where they are none. */
std::string
Compress(const std::string & bytes);
std::string
Decompress(const std::string & gzip);
} // namespace bone

#endif
