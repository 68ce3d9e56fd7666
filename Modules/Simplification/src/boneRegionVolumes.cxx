/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRegionVolumes.h"

#include <algorithm>
#include <cmath>

namespace bone
{
RegionVolumes::RegionVolumes(const TetraComplex & complex)
{
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    if (complex.IsAlive(t))
    {
      const auto at = std::lower_bound(m_Labels.begin(), m_Labels.end(), complex.Region(t));
      if (at == m_Labels.end() || *at != complex.Region(t))
      {
        m_Labels.insert(at, complex.Region(t));
      }
    }
  }
  m_Volumes = this->Measure(complex);
}

std::size_t
RegionVolumes::NumberOf(int label) const
{
  return static_cast<std::size_t>(std::lower_bound(m_Labels.begin(), m_Labels.end(), label) - m_Labels.begin());
}

std::vector<double>
RegionVolumes::Measure(const TetraComplex & complex) const
{
  std::vector<double> volumes(m_Labels.size(), 0.0);
  const auto &        p = complex.Points();
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    if (complex.IsAlive(t))
    {
      const Id4 & c = complex.Cell(t);
      volumes[this->NumberOf(complex.Region(t))] += SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
    }
  }
  return volumes;
}

std::vector<double>
RegionVolumes::ChangesTo(const TetraComplex & complex) const
{
  std::vector<double> changes = this->Measure(complex);
  for (std::size_t r = 0; r < changes.size(); ++r)
  {
    changes[r] -= m_Volumes[r];
  }
  return changes;
}

double
RegionVolumes::LargestChangeTo(const TetraComplex & complex) const
{
  const std::vector<double> changes = this->ChangesTo(complex);
  double                    largest = 0.0;
  for (std::size_t r = 0; r < changes.size(); ++r)
  {
    largest = std::max(largest, std::abs(changes[r]) / m_Volumes[r]);
  }
  return largest;
}
} // namespace bone
