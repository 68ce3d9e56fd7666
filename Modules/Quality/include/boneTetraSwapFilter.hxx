/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraSwapFilter_hxx
#define boneTetraSwapFilter_hxx

#include "boneTetraSwapFilter.h"

namespace bone
{
template <typename TMesh>
void
TetraSwapFilter<TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (!(m_TargetAngle > 0 && m_TargetAngle < 1.23))
  {
    itkExceptionMacro("TargetAngle is " << m_TargetAngle
                                        << " rad; it must lie between 0 and 1.23, the angle of a regular tetrahedron.");
  }
  if (m_MaximumPasses < 0)
  {
    itkExceptionMacro("MaximumPasses is " << m_MaximumPasses << "; it must not be negative.");
  }
}

template <typename TMesh>
void
TetraSwapFilter<TMesh>::Improve(TetraComplex & complex, const ProgressFunction & progress)
{
  FlipParameters parameters;
  parameters.targetAngle = m_TargetAngle;
  parameters.maximumPasses = m_MaximumPasses;
  m_Report = ImproveByFlips(complex, parameters);
  progress(1.0);
}

template <typename TMesh>
void
TetraSwapFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "TargetAngle: " << m_TargetAngle << std::endl;
  os << indent << "MaximumPasses: " << m_MaximumPasses << std::endl;
}
} // namespace bone

#endif
