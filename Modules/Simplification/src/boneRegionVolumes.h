/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegionVolumes_h
#define boneRegionVolumes_h

#include "boneTetraComplex.h"

#include <vector>

namespace bone
{
/** \class RegionVolumes
 * \brief Volume of each region of a complex, mm^3; regions are numbered in ascending order of their labels. */
class RegionVolumes
{
public:
  explicit RegionVolumes(const TetraComplex & complex);

  std::size_t
  Size() const
  {
    return m_Labels.size();
  }
  /** Number of a region that the complex has. */
  std::size_t
  NumberOf(int label) const;
  double
  operator[](std::size_t number) const
  {
    return m_Volumes[number];
  }
  /** By how much another state of the same regions differs from this one. */
  std::vector<double>
  ChangesTo(const TetraComplex & complex) const;
  /** The largest share by which one of them differs. */
  double
  LargestChangeTo(const TetraComplex & complex) const;

private:
  std::vector<double>
  Measure(const TetraComplex & complex) const;

  std::vector<int>    m_Labels;
  std::vector<double> m_Volumes;
};
} // namespace bone

#endif
