/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLeftOutModels_h
#define boneLeftOutModels_h

#include "boneModeAccumulator.h"

#include <functional>

namespace bone
{
/** \class LeftOutModels
 * \brief The principal modes of vectors without one of them, for each of them: those of all, with the one taken out of
 * the sum of squares and products, in the span of what was held of all (\ref ModeAccumulator). Exact where all fit. */
class LeftOutModels
{
public:
  /** For `count` vectors. The first pass: each is written to Next(), then Finish(). */
  LeftOutModels(Eigen::Index dimension, Eigen::Index count);
  Eigen::Ref<Eigen::VectorXd>
  Next()
  {
    return m_All.Next();
  }
  void
  Finish();

  const ModeAccumulator &
  GetAll() const
  {
    return m_All;
  }

  /** The mean of the others. */
  Eigen::VectorXd
  MeanWithout(const Eigen::VectorXd & y) const;

  /** Calls visit(m, nearest) with the vector of the model of the others and its first modes[m] modes, ascending,
   * nearest to x: y itself, or y moved to their mean. */
  void
  Reconstruct(const Eigen::VectorXd &                                                  y,
              const Eigen::VectorXd &                                                  x,
              const std::vector<int> &                                                 modes,
              const std::function<void(std::size_t m, const Eigen::VectorXd & near)> & visit) const;

private:
  ModeAccumulator m_All;
};
} // namespace bone

#endif
