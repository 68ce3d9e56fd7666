/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneInteriorRefinement_h
#define boneInteriorRefinement_h

#include "boneMeshRepair.h"

namespace bone
{
/** \class InteriorRefinement
 * \brief Gives the inside of regions cells of the size that their surfaces ask for.
 *
 * The size at a surface point is the mean length of its surface edges; it grows inward by `gradation` mm a mm. Edges
 * within a region that are much longer than the size at their middle are halved, the longest against its size first;
 * inner points with an edge much shorter than their size are collapsed along it where no angle gets bad. Surfaces stay.
 */
class InteriorRefinement
{
public:
  InteriorRefinement(TetraComplex & complex, MeshRepair & repair, double gradation);

  /** Halves long edges; returns their number. */
  std::size_t
  Split(double factor);

  /** Collapses edges shorter than `factor` sizes where no cell falls below the angle of `cosine` and below the worst
   * that was there, and no edge comes that is longer than `longest` sizes. Returns their number. */
  std::size_t
  Collapse(double factor, double longest, double cosine);

private:
  void
  FindSizes();
  /** Size wanted in the middle of an edge. */
  double
  SizeBetween(IdType a, IdType b) const;

  TetraComplex &      m_Complex;
  MeshRepair &        m_Repair;
  double              m_Gradation;
  std::vector<double> m_Size; ///< #p, mm
};
} // namespace bone

#endif
