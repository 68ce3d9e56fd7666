/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraSmoothingFilter_hxx
#define boneTetraSmoothingFilter_hxx

#include "boneTetraSmoothingFilter.h"

namespace bone
{
template <typename TMesh>
void
TetraSmoothingFilter<TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (m_Iterations < 0 || m_FairingIterations < 0)
  {
    itkExceptionMacro("Iterations (" << m_Iterations << ") and FairingIterations (" << m_FairingIterations
                                     << ") must not be negative.");
  }
  if (!(m_DistanceBound >= 0 && std::isfinite(m_DistanceBound)))
  {
    itkExceptionMacro("DistanceBound is " << m_DistanceBound << " mm; it must be finite and not negative.");
  }
  if (!(m_Weight > 0 && m_Weight < 1))
  {
    itkExceptionMacro("Weight is " << m_Weight << "; it must lie between 0 and 1, both excluded.");
  }
  if (!(m_AngleFloor >= 0 && m_AngleFloor < 1.23))
  {
    itkExceptionMacro("AngleFloor is " << m_AngleFloor
                                       << " rad; it must lie between 0 and 1.23, the angle of a regular tetrahedron.");
  }
}

template <typename TMesh>
void
TetraSmoothingFilter<TMesh>::Improve(TetraComplex & complex, const ProgressFunction & progress)
{
  SmoothingParameters parameters;
  parameters.method = m_Method;
  parameters.iterations = m_Iterations;
  parameters.distanceBound = m_DistanceBound;
  parameters.fairingIterations = m_FairingIterations;
  parameters.weight = m_Weight;
  parameters.angleFloor = m_AngleFloor;
  m_Report = SmoothPoints(complex, parameters, progress);
}

template <typename TMesh>
void
TetraSmoothingFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Method: " << static_cast<int>(m_Method) << std::endl;
  os << indent << "Iterations: " << m_Iterations << std::endl;
  os << indent << "DistanceBound: " << m_DistanceBound << std::endl;
  os << indent << "FairingIterations: " << m_FairingIterations << std::endl;
  os << indent << "Weight: " << m_Weight << std::endl;
  os << indent << "AngleFloor: " << m_AngleFloor << std::endl;
}
} // namespace bone

#endif
