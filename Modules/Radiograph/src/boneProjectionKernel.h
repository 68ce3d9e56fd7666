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

/** Cells whose set-up is done at once. */
constexpr int groupSize = 4;

/** Tetrahedra of one degree as the view sees them, wholly between source and detector. */
struct CellGroup
{
  int            count; ///< 1..groupSize
  int            degree;
  double         column[4][groupSize]; ///< of the projected vertices, pixels
  double         row[4][groupSize];
  double         s[4][groupSize]; ///< ray parameter of the vertices, see RayFrame
  const double * coefficients[groupSize];
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

/** Adds the tetrahedra's integrals to the band, in order. What is beyond `count` is filled by the function. */
using AddCellsFunction = void (*)(CellGroup & group, const Band & band);

void
AddCellsPortable(CellGroup & group, const Band & band);

#if defined(__x86_64__) && defined(__GNUC__)
#define BONE_PROJECTION_X86
void
AddCellsAvx2(CellGroup & group, const Band & band);
void
AddCellsAvx512(CellGroup & group, const Band & band);
#endif

/** The fastest one that this processor can run. */
AddCellsFunction
SelectAddCells();
} // namespace projection
} // namespace bone

#endif
