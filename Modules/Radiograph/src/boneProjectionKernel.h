/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneProjectionKernel_h
#define boneProjectionKernel_h

#include <cstddef>

namespace bone
{
namespace projection
{
/** Pixels that are computed at once; a band's rows are padded by as many. */
constexpr int lanes = 8;

/** A tetrahedron as the view sees it, wholly between source and detector. */
struct Cell
{
  double         column[4]; ///< of the projected vertices, pixels
  double         row[4];
  double         s[4]; ///< ray parameter of the vertices, see RayFrame
  const double * coefficients;
  int            degree;
  double         scale; ///< scale * density + offset is integrated
  double         offset;
  bool           parallel;
};

/** Rows [firstRow, endRow) of the image, to be added to: integrals in s, not yet times the rays' step length. */
struct Band
{
  float *        data; ///< pixel (0, firstRow)
  std::ptrdiff_t stride;
  int            firstRow;
  int            endRow;
  int            columns;
};

/** Adds one tetrahedron's integrals to the band. */
using AddCellFunction = void (*)(const Cell &, const Band &);

void
AddCellPortable(const Cell & cell, const Band & band);

#if defined(__x86_64__) && defined(__GNUC__)
#define BONE_PROJECTION_AVX2
void
AddCellAvx2(const Cell & cell, const Band & band);
#endif

/** The fastest one that this processor can run. */
AddCellFunction
SelectAddCell();
} // namespace projection
} // namespace bone

#endif
