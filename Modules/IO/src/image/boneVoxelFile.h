/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelFile_h
#define boneVoxelFile_h

#include <itk_zlib.h>

#include <cstddef>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace bone
{
/** Where a file has the voxels of an image. */
struct VoxelPlace
{
  std::string path;
  std::size_t start{ 0 };          ///< byte of the file at which the voxels, or the stream that holds them, begin
  std::size_t skip{ 0 };           ///< bytes of the stream before the voxels
  std::size_t bytes{ 0 };          ///< of voxels
  bool        compressed{ false }; ///< the stream is one of zlib or gzip
  bool        mayGoOn{ false };    ///< after the voxels other data may follow, in the stream or in further gzip members
};

/** \brief The bytes of an image's voxels, of which any part can be read.
 *
 * What is compressed can be entered where it begins, and once Scan has passed over it at points a few MB apart, for
 * each of which the 32 KB are kept that the stream refers back to (as zlib's example `zran` shows). */
class VoxelFile
{
public:
  explicit VoxelFile(VoxelPlace place);
  ~VoxelFile();
  VoxelFile(const VoxelFile &) = delete;
  VoxelFile &
  operator=(const VoxelFile &) = delete;

  /** Whether the file is long enough, as far as can be told without reading it. */
  bool
  IsLongEnough() const;

  /** Passes over all voxels; `look`, where there is one, sees them block by block, of whole 8 bytes but for the last.
   * False where they are not all there, or do not agree with their checksum. */
  bool
  Scan(const std::function<void(const std::vector<char> & block)> & look);

  /** Reads `count` bytes of voxels from the byte `from` on; false where that is not possible. */
  bool
  Read(std::size_t from, std::size_t count, char * to);

  /** After the last voxel was read: whether what is compressed ends as it must, with its checksum. Such a checksum is
   * known where all was read from the beginning. */
  bool
  EndsWell();

private:
  /** Where a compressed stream can be entered. */
  struct Entry
  {
    std::size_t                to{ 0 };   ///< bytes of the stream before it
    std::size_t                from{ 0 }; ///< byte of the file
    int                        bits{ 0 }; ///< of the byte before, which belong to what follows
    std::vector<unsigned char> window;    ///< what comes before; empty where a header follows
  };

  void
  Enter(const Entry & entry);
  void
  Fill();
  /** As many bytes as there are, up to `count`. */
  std::size_t
  Inflate(char * to, std::size_t count);
  void
  FinishMember();
  void
  NoteEntry();
  bool
  Skip(std::size_t count);

  VoxelPlace         m_Place;
  std::ifstream      m_File;
  std::vector<Entry> m_Entries; ///< ascending
  std::vector<char>  m_Input;
  std::size_t        m_InputEnd{ 0 }; ///< byte of the file after what is in m_Input
  z_stream           m_Stream{};
  std::size_t        m_At{ 0 }; ///< bytes of the stream before the next one
  bool               m_Entered{ false };
  bool               m_Headless{ false }; ///< entered after its header: the checksum is passed over
  bool               m_Noting{ false };
  bool               m_Ended{ false };
  bool               m_Damaged{ false };
};
} // namespace bone

#endif
