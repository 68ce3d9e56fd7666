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

/** What is derived from a group's integrals I beside I itself. For a displacement of the cell's vertices j by w_j,
 * dI = sum over i = 1..3, j = 0..3 of (gradient of barycentric coordinate i) . w_j times a function K_ij of the pixel.
 */
struct Derivatives
{
  int                    shapeModes;
  const double *         shape[groupSize]; ///< of each cell: modes x 3 x 4, gradient i . w_j
  int                    densityModes;
  const double * const * density;                ///< coefficients of each mode
  std::ptrdiff_t         coefficient[groupSize]; ///< where each cell's begin
  std::ptrdiff_t         plane;                  ///< floats in the band from one derivative to the next
  double *               scratch;                ///< DerivativeScratch() numbers
};

constexpr std::size_t
DerivativeScratch(int shapeModes, int densityModes)
{
  return static_cast<std::size_t>(shapeModes) * 12 + static_cast<std::size_t>(densityModes) * 165;
}

/** Sums over the pixels, of which the band holds the weights. */
struct Adjoint
{
  double * basis[groupSize];     ///< of each cell: weight times integral of each Bernstein polynomial; not scaled
  double * positions[groupSize]; ///< of each cell or null: weight times K_ij, 3 x 4
};

/** Each takes 1..groupSize tetrahedra of one degree; what is beyond `count` is filled by the function. */
struct Kernels
{
  /** Adds the tetrahedra's integrals to the band, in order. */
  void (*add)(CellGroup & group, const Band & band);
  /** The same, and derivatives by shape modes and by density modes to the planes that follow. */
  void (*derive)(CellGroup & group, const Derivatives & derivatives, const Band & band);
  /** Sets the sums of each cell. */
  void (*adjoin)(CellGroup & group, const Adjoint & adjoint, const Band & band);
};

extern const Kernels portableKernels;

#if defined(__x86_64__) && defined(__GNUC__)
#define BONE_PROJECTION_X86
extern const Kernels avx2Kernels;
extern const Kernels avx512Kernels;
#endif

/** The fastest ones that this processor can run. */
const Kernels &
SelectKernels(bool portable);
} // namespace projection
} // namespace bone

#endif
