/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneScatter_h
#define boneScatter_h

#include "boneExecution.h"
#include "boneTypes.h"

#include <vector>

namespace bone
{
/** \defgroup Scatter Scattered photons
 *
 * A model of the scatter that a body adds to its radiograph. Of P primary photons of the I0 in the open beam,
 *
 *   S = ratio * G (P (1 - P / I0)^2),
 *
 * are added as scatter, with G a blur by a Gaussian. The source of scatter is the primary where the beam was
 * attenuated: the open beam, P = I0, scatters nothing, and behind a body that lets few photons through the scatter is
 * `ratio` times the primary near by. Thin bodies scatter by the square of their line integral. Up to a ratio of 3, P +
 * S rises with P, so that it tells P; higher ratios are not taken. Beyond the detector the image goes on as at its
 * edge. Kernel models of this kind are described by Ohnesorge, Flohr and Klingenbeck-Regn 1999
 * (doi:10.1007/s003300050710) and Sun and Star-Lack 2010 (doi:10.1088/0031-9155/55/22/007).
 * \{ */

/** Columns and rows, and mm from pixel to pixel. */
struct DetectorGrid
{
  std::array<int, 2> size{ { 0, 0 } };
  Vector2            spacing{ 1, 1 };

  std::size_t
  Count() const
  {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  }
};

struct ScatterModel
{
  double ratio{ 0.0 };  ///< scatter to primary behind a body
  double width{ 50.0 }; ///< standard deviation of the Gaussian, mm at the detector
  double open{ 1.0 };   ///< I0, photons of the open beam
};

/** The values blurred by a Gaussian of standard deviation `width` mm. Wide ones are made on a coarser grid. */
std::vector<double>
BlurWidely(const std::vector<double> & values, const DetectorGrid & grid, double width, const Execution & execution);

/** S of primary photons, row by row. */
std::vector<double>
ComputeScatter(const std::vector<double> & primary,
               const DetectorGrid &        grid,
               const ScatterModel &        model,
               const Execution &           execution);

struct ScatterSolution
{
  std::vector<double> primary;
  int                 iterations{ 0 };
  double              change{ 0.0 }; ///< the last one's largest, as part of the largest scatter
};

/** The primary photons P whose sum with their scatter is `total`, by the iteration P <- T P / (P + S(P)) until P
 * changes by less than 1e-6 of itself. P is kept above `leastShare` of T. */
ScatterSolution
SubtractScatter(const std::vector<double> & total,
                const DetectorGrid &        grid,
                const ScatterModel &        model,
                double                      leastShare,
                const Execution &           execution);
/** \} */
} // namespace bone

#endif
