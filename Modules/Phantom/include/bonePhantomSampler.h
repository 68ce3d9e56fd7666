/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePhantomSampler_h
#define bonePhantomSampler_h

#include "bonePhantomModel.h"

#include <vector>

namespace bone
{
/** A regular grid in physical space: index i is at origin + axes * (spacing .* i), mm. `axes` is orthonormal. */
struct PhantomGrid
{
  Vector3         origin{ Vector3::Zero() };
  Eigen::Matrix3d axes{ Eigen::Matrix3d::Identity() };
  Vector3         spacing{ Vector3::Ones() };

  Vector3
  At(double i, double j, double k) const
  {
    return origin + axes * spacing.cwiseProduct(Vector3(i, j, k));
  }
};

/** A box of grid indices. */
struct PhantomBlock
{
  std::array<long, 3>        start{ { 0, 0, 0 } };
  std::array<std::size_t, 3> size{ { 0, 0, 0 } };
};

/** \class PhantomSampler
 * \brief Blurred densities and labels of a phantom on a grid.
 *
 * The point spread is a Gaussian with its axes along the grid's. Its covariance is split in two: what
 * PhantomModel::BlurredDensity does in closed form (along each axis all of a standard deviation up to AnalyticSigma, of
 * a larger one about half), and the rest, a separable sum over a grid finer than the voxels. Only near a surface is the
 * model evaluated in full: blocks of about 2 mm further away than the point spread reaches are soft tissue or a single
 * material.
 *
 * A value depends on its own index alone, not on the block it was asked with, so work may be divided freely. */
class PhantomSampler
{
public:
  /** A standard deviation (mm) up to which the closed form does it all, and the most it does of a larger one. */
  static constexpr double AnalyticSigma = 0.45;
  static constexpr double LargestAnalyticSigma = 0.6;

  /** `sigma`: standard deviations of the point spread along the grid's axes, mm; 0 gives the ideal density. */
  PhantomSampler(PhantomModel::Pointer model, const PhantomGrid & grid, const Vector3 & sigma);

  /** Density (HU, noise-free) at every index of the block, first index fastest. */
  void
  SampleDensity(const PhantomBlock & block, float * density) const;

  /** Region at every index of the block, first index fastest. */
  void
  SampleRegions(const PhantomBlock & block, short * regions) const;

private:
  class Neighbourhoods;

  /** The summed part of the point spread along one axis: voxel i is the sum over t of weights[t] times fine sample
   * First(i) + t. The taps lie symmetrically about the voxel's centre, fine sample j of the factor n in a voxel at
   * (j + 1/2) / n of the voxel. */
  struct Kernel
  {
    long                factor{ 1 };
    std::vector<double> weights{ 1.0 };

    long
    First(long voxel) const
    {
      return voxel * factor + (factor - static_cast<long>(weights.size())) / 2;
    }
  };

  static Kernel
  MakeKernel(double spacing, double sigma);
  double
  SampleFine(signed char content, const Vector3 & x) const;
  /** False where all of the row is soft tissue. */
  bool
  SampleFineRow(const Neighbourhoods & neighbourhoods, long start, long j, long k, std::vector<double> & row) const;
  void
  SampleFineSlice(const Neighbourhoods & neighbourhoods,
                  const PhantomBlock &   block,
                  long                   k,
                  std::vector<double> &  slice) const;

  PhantomModel::Pointer m_Model;
  PhantomGrid           m_Grid;
  PhantomGrid           m_Fine;
  Vector3               m_AnalyticSigma;
  std::array<Kernel, 3> m_Kernels;
  double                m_SoftTissue;
};

/** Standard normal noise at a voxel: a hash of seed and the voxel's number alone. */
double
PhantomNoise(std::uint64_t seed, std::uint64_t voxel);
} // namespace bone

#endif
