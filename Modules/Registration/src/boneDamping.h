/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDamping_h
#define boneDamping_h

#include <Eigen/Core>

#include <algorithm>
#include <limits>

namespace bone
{
/** Gauss-Newton's matrix of patch-wise gradient correlation is larger than the cost's curvature: along steps of rigid
 * registrations by 1.0 to 2.5 on a femur, 0.9 to 1.8 on a hip bone. Steps so much longer than it says are fewer: of
 * deformable ones to 18 femora 5.6 in place of 6.8 on the last images, with 1.6 6.4. */
inline constexpr double LongerSteps = 1.35;

/** \class Damping
 * \brief How much Levenberg-Marquardt steps are damped: less after each that gained, much more after one that did
 * not. */
class Damping
{
public:
  /** The matrix with its diagonal raised, by `floor` too, so that it can be inverted. */
  template <typename TMatrix>
  TMatrix
  Damp(TMatrix hessian, double floor = 0.0) const
  {
    hessian.diagonal() *= 1.0 + m_Value;
    hessian.diagonal().array() += floor + std::numeric_limits<double>::min();
    return hessian;
  }

  void
  Tell(bool gained)
  {
    m_Value = gained ? std::max(1e-6, 0.2 * m_Value) : std::max(0.1, 10.0 * m_Value);
    m_Refusals = gained ? 0 : m_Refusals + 1;
  }

  /** Two steps one after the other gained nothing. */
  bool
  IsStuck() const
  {
    return m_Refusals == 2;
  }

private:
  double m_Value{ 1e-3 };
  int    m_Refusals{ 0 };
};
} // namespace bone

#endif
