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
TetraSwapFilter<TMesh>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
}

template <typename TMesh>
void
TetraSwapFilter<TMesh>::Improve(TetraComplex & complex, const Execution & execution)
{
  FlipParameters parameters;
  static_cast<TetraSwapParameters &>(parameters) = this->GetParameters();
  m_Report = ImproveByFlips(complex, parameters, {}, nullptr, execution);
}

template <typename TMesh>
void
TetraSwapFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
}
} // namespace bone

#endif
