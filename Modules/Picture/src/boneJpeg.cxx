/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneJpeg.h"

#include <cstdio>
#include <cstdlib>
#include <new>
#include <stdexcept>

#include <jpeglib.h>

namespace bone
{
std::string
ToJpeg(const PictureImage * picture, int quality)
{
  const auto size = picture->GetBufferedRegion().GetSize();
  if (size[0] == 0 || size[1] == 0 || size[0] > JPEG_MAX_DIMENSION || size[1] > JPEG_MAX_DIMENSION)
  {
    throw std::invalid_argument("a JPEG has 1 to 65500 pixels along each side");
  }
  if (quality < 1 || quality > 100)
  {
    throw std::invalid_argument("the quality of a JPEG is 1 to 100");
  }
  jpeg_error_mgr       errors{};
  jpeg_compress_struct compressor{};
  compressor.err = jpeg_std_error(&errors);
  errors.error_exit = [](j_common_ptr) { throw std::bad_alloc(); }; // sizes are right: memory alone can fail
  unsigned char * bytes = nullptr;
  unsigned long   length = 0;
  jpeg_create_compress(&compressor);
  jpeg_mem_dest(&compressor, &bytes, &length);
  compressor.image_width = static_cast<JDIMENSION>(size[0]);
  compressor.image_height = static_cast<JDIMENSION>(size[1]);
  compressor.input_components = 3;
  compressor.in_color_space = JCS_RGB;
  jpeg_set_defaults(&compressor);
  jpeg_set_quality(&compressor, quality, TRUE);
  compressor.optimize_coding = TRUE;
  jpeg_simple_progression(&compressor); // a tenth smaller
  compressor.comp_info[0].h_samp_factor = compressor.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&compressor, TRUE);
  const auto * pixels = reinterpret_cast<const unsigned char *>(picture->GetBufferPointer());
  while (compressor.next_scanline < compressor.image_height)
  {
    JSAMPROW row = const_cast<unsigned char *>(pixels + 3 * size[0] * compressor.next_scanline);
    jpeg_write_scanlines(&compressor, &row, 1);
  }
  jpeg_finish_compress(&compressor);
  std::string file(reinterpret_cast<const char *>(bytes), length);
  jpeg_destroy_compress(&compressor);
  std::free(bytes);
  return file;
}
} // namespace bone
