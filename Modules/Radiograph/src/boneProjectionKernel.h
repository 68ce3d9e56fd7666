/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneProjectionKernel_h
#define boneProjectionKernel_h

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace bone
{
namespace projection
{
/** Pixels that are computed at once; a band's rows are padded by as many. */
constexpr int lanes = 8;

/** Rows after a band's last, and columns after its last, that Kernels::add may write to and Kernels::adjoin read. */
constexpr int spareRows = 1;
constexpr int spareColumns = 16;

/** Cells whose set-up in double precision is done at once. */
constexpr int groupSize = 4;

/** Blocks of eight tetrahedra of one degree, wholly between source and detector, and how they are seen. */
struct BlockRun
{
  const std::int32_t * blocks;       ///< the numbers of the blocks
  std::size_t          count;        ///< number of blocks
  const double *       vertices;     ///< of each block: 4 vertices, 3 coordinates (mm), eight tetrahedra
  const float *        coefficients; ///< of each block: expansions of what is integrated, see bonePowerKernel.hxx, then
                                     ///< the largest magnitude of a Bernstein coefficient, eight tetrahedra
  const std::int32_t * cells;        ///< of each block: eight; -1 after the last of all
  const double *       density;      ///< coefficients as they are given, a row a tetrahedron
  std::size_t          densityStride; ///< numbers from row to row
  int                  degree;
  double               scale; ///< scale * density + offset is integrated
  double               offset;
  double               origin[3]; ///< origin of the rays
  double toPixel[3][3];           ///< from a displacement to (s, column s, row s), in a parallel beam (s, column, row)
  bool   parallel;
};

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

/** Rows [firstRow, endRow) and columns [firstColumn, columns) of the image. Kernels::add adds to them integrals in s,
 * not yet times the rays' step length; Kernels::derive takes stride and firstColumn in pixels of all modes' numbers. */
struct Band
{
  float *        data; ///< pixel (firstColumn, firstRow)
  std::ptrdiff_t stride;
  int            firstRow;
  int            endRow;
  int            columns;
  int            firstColumn{ 0 };
};

/** Modes that are computed at once: a pixel has whole blocks of as many numbers. */
constexpr int modeLanes = 16;
constexpr int
BlockCount(std::size_t modes)
{
  return static_cast<int>((modes + modeLanes - 1) / modeLanes);
}

/** The task of Kernels::derive. At each pixel lie the derivatives by displacements of the vertices, in blocks, then, in
 * blocks, the integrals of density modes, of which the first is the density itself. */
struct Derivatives
{
  int                    vertexBlocks;
  const float *          displacement; ///< of each point: 3 x modes in blocks, see boneRayTerms.hxx
  const std::int32_t *   vertices;     ///< of each cell: 4 points
  int                    densityBlocks;
  int                    densityModes;
  const double * const * density; ///< coefficients of each mode, a cell's as far apart as BlockRun::density
};

/** The results of Kernels::adjoin: derivatives of the sum over the band's pixels of their numbers times the integrals.
 */
struct Adjoint
{
  double * coefficients; ///< of each cell, as far apart as BlockRun::density
  double * positions;    ///< of each cell: 4 vertices x 3, in space; or null
};

/** The kernels of one instruction set. A group has 1..groupSize tetrahedra of one degree. */
struct Kernels
{
  /** Replaces a block's Bernstein coefficients by their expansions, see bonePowerKernel.hxx. */
  void (*expand)(int degree, float * coefficients);
  /** Adds the tetrahedra's integrals to the band, in order. */
  void (*add)(const BlockRun & run, const Band & band);
  /** The same with derivatives. */
  void (*derive)(const BlockRun & run, const Derivatives & derivatives, const Band & band);
  /** Sets the derivatives of each cell of the run; the band is read. */
  void (*adjoin)(const BlockRun & run, const Adjoint & adjoint, const Band & band);
};

extern const Kernels portableKernels;

#if defined(__x86_64__) && defined(__GNUC__)
#define BONE_PROJECTION_X86
extern const Kernels avx2Kernels;
extern const Kernels avx512Kernels;
#endif

/** The fastest kernels that this processor can run. */
const Kernels &
SelectKernels(bool portable);
} // namespace projection
} // namespace bone

#endif
