/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceSamples_h
#define boneSurfaceSamples_h

#include "boneTetraComplex.h"

#include <vector>

namespace bone
{
/** \class SurfaceSamples
 * \brief The removed points of boundary, interfaces and flat cuts, each known to the cell whose face is nearest.
 *
 * They stand for the surfaces of the finest level: the distance of a later surface is measured at them, weighted with
 * the area that each had at first. */
class SurfaceSamples
{
public:
  explicit SurfaceSamples(const TetraComplex & complex);

  struct Cost
  {
    double integral{ 0.0 };        ///< squared distance times area, mm^4, growth by the collapse
    double largestDistance{ 0.0 }; ///< mm, after the collapse, of the points looked at
  };

  /** What the collapse v -> w would do to the surfaces around v. Zero for a point within a region. */
  Cost
  CollapseCost(const TetraComplex & complex, IdType v, IdType w) const;

  /** Takes the points out of cells that are about to be replaced; adds v itself, which is about to be removed (-1:
   * none). */
  std::vector<int>
  TakeFrom(const TetraComplex & complex, const std::vector<IdType> & cells, IdType v);

  /** Gives points to the nearest face of their surface that one of the cells carries. */
  void
  GiveTo(const TetraComplex & complex, const std::vector<int> & samples, const std::vector<IdType> & cells);

  /** Gives all points to the nearest face of their surface. */
  void
  Distribute(const TetraComplex & complex);

private:
  struct Sample
  {
    Vector3 x;
    int     surface;
    double  area;
    double  squaredDistance;
  };
  struct Share
  {
    int    surface;
    double area;
  };

  std::vector<Sample>             m_Samples;
  std::vector<std::vector<int>>   m_InCell;
  std::vector<std::vector<Share>> m_Shares; ///< #p, each surface at the point and a third of its faces' area there
};
} // namespace bone

#endif
