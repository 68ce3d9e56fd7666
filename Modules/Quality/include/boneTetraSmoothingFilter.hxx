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
TetraSmoothingFilter<TMesh>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
}

template <typename TMesh>
void
TetraSmoothingFilter<TMesh>::Improve(TetraComplex & complex, const Execution & execution)
{
  m_Report = SmoothPoints(complex, this->GetParameters(), execution);
}

template <typename TMesh>
void
TetraSmoothingFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
}
} // namespace bone

#endif
