/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSlabFiller_h
#define boneSlabFiller_h

#include "boneLayerLinks.h"
#include "bonePlanarOverlay.h"
#include "boneSlabCuts.h"
#include "boneSlabFilling.h"
#include "boneSlabSide.h"
#include "boneSlabSurface.h"
#include "boneSteinerCollapse.h"

#include <set>
#include <vector>

namespace bone
{
namespace tiling
{
/** \brief Fills the space between the triangulations of two slices, laid over each other as they are: steps 2 and 3 of
 * \ref FillSlab. */
class SlabFiller
{
public:
  SlabFiller(const ContourStack &  stack,
             const SlabSide &      lower,
             const SlabSide &      upper,
             int                   slice,
             const VertexPool &    pool,
             std::vector<PieceCut> cuts,
             const Execution &     execution);

  /** Area of bone that has the same region, of the same group, on both slices. */
  double
  CommonArea() const;

  std::set<LayerLink>
  Links() const;

  /** The groups with members on both slices that overlap does not join into one. */
  std::vector<int>
  SeparatedGroups(const std::vector<Group> & groups) const;

  /** `thin`: whether a cell is so flat that it may be inverted in another frame. */
  SlabFilling
  Run(double low, double high, const Execution & execution, bool & thin);

private:
  /** True where a triangle of the overlay lies in the same group on both slices. */
  bool
  Together(const PlanarOverlay::Triangle & t) const;

  void
  MakeColumns();

  /** A point in the stack's frame, where all of a slice are at exactly one height. */
  static Vector3
  At(const Vector2 & q, double height);

  void
  MakePoints(double low, double high);

  /** Where the points in between belong. */
  SteinerPlaces
  PlacesOf(double low, double high) const;

  IdType
  Steiner(int plane, int v) const;

  void
  AddCell(IdType a, IdType b, IdType c, IdType d, bool mirrored, int region);

  /** The prisms between the slices and the overlay next to them. */
  void
  FillPrisms();

  /** The cells of a prism at the side opposite its smallest vertex: a fan about the smaller end of that side's edge. */
  void
  FillSideOpposite(int s, int plane, const std::array<int, 3> & v, int region);

  /** Prisms between the copies of the overlay. */
  void
  FillMiddle();

  /** The bone among the cells; vertices in between get the layer that they bound. */
  SlabFilling
  BoneOf(const MeshArrays & filled) const;

  /** Throws where a cell turned over when its points were brought from the stack's frame to space. */
  void
  VerifyInSpace(const SlabFilling & filling) const;

  const ContourStack &  m_Stack;
  const SlabSide *      m_Sides[2];
  int                   m_Slice;
  const VertexPool &    m_Pool;
  std::vector<PieceCut> m_Cuts;
  PlanarOverlay         m_Overlay;
  std::vector<Column>   m_Columns;
  int                   m_Planes{ 1 };
  MeshArrays            m_Mesh;
  IdType                m_First[2];
  IdType                m_FirstSteiner{ 0 };
};
} // namespace tiling
} // namespace bone

#endif
