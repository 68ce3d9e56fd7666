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

/** Rows after a band's last that Kernels::add may write to. */
constexpr int spareRows = 1;

/** Cells whose set-up in double precision is done at once. */
constexpr int groupSize = 4;

/** Tetrahedra of one degree, wholly between source and detector. */
struct CellRun
{
  const std::int32_t * ids;
  std::size_t          count;
  const double *       points;       ///< of each: column, row, s (see RayFrame) and 0
  const std::int32_t * vertices;     ///< four a tetrahedron
  const double *       coefficients; ///< a row a tetrahedron
  std::size_t          stride;       ///< from row to row
  int                  degree;
  double               scale; ///< scale * density + offset is integrated
  double               offset;
  bool                 parallel;
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

/** Rows [firstRow, endRow) of the image, to be added to: integrals in s, not yet times the rays' step length. */
struct Band
{
  float *        data; ///< pixel (0, firstRow)
  std::ptrdiff_t stride;
  int            firstRow;
  int            endRow;
  int            columns;
};

/** What is derived from a group's integrals beside these themselves, one plane each in the order below. Displacements
 * of vertices are in the coordinates (s, column s, row s), in a parallel beam (s, column, row). */
struct Derivatives
{
  bool                   pose;   ///< four planes: displacement by 1 along columns, along rows, and by s - middle along
  double                 middle; ///< both
  int                    shapeModes;
  const double *         shape[groupSize][4]; ///< of each cell and vertex: modes x 3, and one number more
  int                    densityModes;
  const double * const * density;                ///< coefficients of each mode
  std::ptrdiff_t         coefficient[groupSize]; ///< where each cell's begin
  int                    nextCount;              ///< of cells in the group to come, whose coefficients are fetched
  std::ptrdiff_t         next[groupSize];        ///< where theirs begin
  std::ptrdiff_t         plane;                  ///< floats in the band from one derivative to the next
  void *                 scratch;                ///< DerivativeScratch() bytes, aligned for Group
};

constexpr int posePlanes = 4;
constexpr int shapeFunctions = 9, shapeLevels = 3; ///< see boneDerivativeKernel.hxx

/** Products of two variables up to a degree. */
constexpr int
PlaneCount(int degree)
{
  return (degree + 1) * (degree + 2) / 2;
}

/** Functions of a row that are computed at once. */
constexpr int tableLanes = 16;
constexpr std::size_t
RowTableSize(std::size_t count, std::size_t levels)
{
  return (count + tableLanes - 1) / tableLanes * tableLanes * (levels + 1);
}
/** Numbers, eight cells each, of the modes' tables of a group: those of density or those of shape. */
constexpr std::size_t
PairCount(std::size_t shapeModes, std::size_t densityModes, int degree)
{
  const std::size_t density = PlaneCount(degree) * ((densityModes + 1) / 2) * (degree + 1);
  const std::size_t shape = shapeFunctions * ((shapeModes + 1) / 2) * shapeLevels;
  return density > shape ? density : shape;
}
/** Bytes: see ModeTables. */
constexpr std::size_t
DerivativeScratch(std::size_t shapeModes, std::size_t densityModes, int degree)
{
  const std::size_t density = PlaneCount(degree) * densityModes, levels = degree + 1;
  const std::size_t shape = shapeFunctions * shapeModes;
  const std::size_t member = RowTableSize(density, levels) + RowTableSize(shape, shapeLevels);
  return sizeof(float) * (groupSize * member + 2 * groupSize * PairCount(shapeModes, densityModes, degree)) +
         sizeof(double) * (member + groupSize * (density * levels + shape * shapeLevels));
}

/** Sums over the pixels, of which the band holds the weights. */
struct Adjoint
{
  double * basis[groupSize];     ///< of each cell: weight times integral of each Bernstein polynomial; not scaled
  double * positions[groupSize]; ///< of each cell, or all null: 4 vertices x 3, by their displacements as above
};

/** Those of a group take 1..groupSize tetrahedra of one degree and fill up what is beyond `count`. */
struct Kernels
{
  /** Adds the tetrahedra's integrals to the band, in order. */
  void (*add)(const CellRun & run, const Band & band);
  /** The same for a group, and derivatives by shape modes and by density modes to the planes that follow. */
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
