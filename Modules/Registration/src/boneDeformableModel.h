/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDeformableModel_h
#define boneDeformableModel_h

#include "boneDeformableRadiographParameters.h"
#include "boneExecution.h"
#include "boneStatisticalModel.h"

namespace bone
{
/** Diagonal of the bounding box. */
double
ExtentOf(const std::vector<Vector3> & points);

/** Volume (mm^3), mean density and their product of each region from 0 on, and last of the whole: a row each. `means`
 * are those of the cells. */
Eigen::MatrixXd
MeasureCells(const MeshCells & mesh, const std::vector<Vector3> & points, const std::vector<double> & means);

/** \struct CoarseModel
 * \brief A simplified mean with one density in each cell, and leading modes of shape: for many small images. */
struct CoarseModel
{
  MeshArrays                        mesh;
  std::vector<std::vector<Vector3>> displacements;

  std::vector<Vector3>
  MovePoints(const Eigen::VectorXd & coefficients) const;
};

/** \struct DeformableModel
 * \brief The atlas as registration moves it: a mean, and linear modes of independent standard normal coefficients: the
 * atlas' of shape, smooth ones, the atlas' of density, and one of each region's density as a whole, with the variance
 * of what the atlas' modes leave of it. */
struct DeformableModel
{
  DeformableModel(const StatisticalModelContent & atlas, const DeformableRadiographParameters & parameters);

  MeshArrays                        mean;
  std::vector<double>               meanDensities; ///< of the mean's cells
  std::vector<std::vector<Vector3>> displacements; ///< of shape, then smooth; mm per standard deviation
  std::vector<std::vector<double>>  cellDensities; ///< changes of the cells' means per standard deviation
  std::vector<std::vector<double>>  densities;     ///< changes of the coefficients per standard deviation
  double       residualVariance{ 0.0 };            ///< of a point along an axis, beside the atlas' modes; mm^2
  Eigen::Index shapeModes{ 0 };
  Eigen::Index smoothModes{ 0 };
  Eigen::Index densityModes{ 0 }; ///< with those of the regions

  Eigen::Index
  GetNumberOfCoefficients() const
  {
    return shapeModes + smoothModes + densityModes;
  }

  std::vector<Vector3>
  MovePoints(const Eigen::VectorXd & coefficients) const;

  /** A row for each region from 0 on, and one for the whole bone: volume (mm^3), mean density, density times volume. */
  Eigen::MatrixXd
  MeasureRegions(const Eigen::VectorXd & coefficients) const;

  /** For each coefficient, how the table of MeasureRegions rises with it. */
  std::vector<Eigen::MatrixXd>
  RegionSlopes(const Eigen::VectorXd & coefficients) const;

  /** With as many tetrahedra or fewer, where the mean can be simplified so far. */
  CoarseModel
  Coarsen(std::size_t tetrahedra, Eigen::Index modes, const Execution & execution) const;

  /** The mesh of the coefficients: shape, smooth, density. */
  MeshArrays
  Synthesize(const Eigen::VectorXd & coefficients) const;

private:
  /** Means of the cells. */
  std::vector<double>
  CellDensities(const Eigen::VectorXd & coefficients) const;
  void
  AddDensity(const std::vector<double> & change);
  void
  AddRegions(const StatisticalModelContent & atlas);
};
} // namespace bone

#endif
