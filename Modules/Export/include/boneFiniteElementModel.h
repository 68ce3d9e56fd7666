/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFiniteElementModel_h
#define boneFiniteElementModel_h

#include "boneElasticityLaw.h"
#include "boneFiniteElementParameters.h"
#include "boneLandmarkIO.h"
#include "boneMeshArrays.h"

#include <array>
#include <string>
#include <vector>

namespace bone
{
/** An isotropic, linear elastic material. */
struct FiniteElementMaterial
{
  double modulus{ 0.0 };     ///< Young's modulus, MPa
  double massDensity{ 0.0 }; ///< t/mm^3
};

/** Nodes or elements by their index, ascending. */
struct FiniteElementSet
{
  std::string         name;
  std::vector<IdType> ids;
};

/** The face of an element that lies opposite a corner. */
struct FiniteElementFace
{
  IdType element{ 0 };
  int    opposite{ 0 }; ///< the corner, 0 to 3
};

/** \struct FiniteElementModel
 * \brief Tetrahedral elements with materials and sets, in mm, N, MPa and t. Indices begin at 0.
 *
 * An element's nodes are its corners, and with ten nodes those on the edges 01, 12, 20, 03, 13, 23, as in VTK, Abaqus,
 * CalculiX and FEBio. */
struct FiniteElementModel
{
  int                                 order{ 2 };
  std::vector<Vector3>                nodes;    ///< mm; corners first, in the mesh's order
  std::vector<std::array<IdType, 10>> elements; ///< of the mesh's tetrahedra, in their order; the first 4 with order 1
  std::vector<int>                    region;   ///< of each element
  std::vector<int>                    material; ///< of each element, index into `materials`
  std::vector<double>                 modulus;  ///< of each element, MPa, before binning
  std::vector<double>                 massDensity; ///< of each element, t/mm^3
  std::vector<double>                 nodeModulus; ///< of each node, MPa
  std::vector<FiniteElementMaterial>  materials;   ///< softest first, none without elements
  std::vector<FiniteElementSet>       nodeSets;
  std::vector<FiniteElementSet>       elementSets;
  std::vector<FiniteElementFace>      exterior; ///< faces of the surface EXTERIOR
  ElasticityLaw                       law;
  FiniteElementParameters             parameters;

  IdType softElements{ 0 };   ///< elements whose modulus was raised to the least
  double shareOutside{ 0.0 }; ///< of the volume, whose mean density the law's specimens do not cover
  double binErrorMean{ 0.0 }; ///< of the elements' moduli by their bins, relative, mean by volume
  double binErrorLargest{ 0.0 };

  int
  NodesEach() const
  {
    return order == 2 ? 10 : 4;
  }
};

/** The corners of an element's face opposite each corner, such that their normal points outward. */
constexpr std::array<std::array<int, 3>, 4> FiniteElementFaceCorners = {
  { { { 1, 2, 3 } }, { { 0, 3, 2 } }, { { 0, 1, 3 } }, { { 0, 2, 1 } } }
};

/** The corners of an element's edges, in the order of the nodes on them, which follow the corners. */
constexpr std::array<std::array<int, 2>, 6> FiniteElementEdges = {
  { { { 0, 1 } }, { { 1, 2 } }, { { 2, 0 } }, { { 0, 3 } }, { { 1, 3 } }, { { 2, 3 } } }
};

/** The position among an element's ten nodes of the one on the edge between two corners. */
int
FiniteElementEdgeNode(int cornerA, int cornerB);

/** The nodes of an element's face: three corners, seen from outside counter-clockwise, and with ten nodes those on the
 * edges from each to the next. */
std::vector<IdType>
FiniteElementFaceNodes(const FiniteElementModel & model, const FiniteElementFace & face);

/** \brief Elements, materials and sets of a density mesh whose density is ash or apparent density (g/cm^3).
 *
 * The modulus of an element is the mean of the law's modulus over it, by 14 points (N. J. Walkington's rule of degree
 * 5): a law rises faster than the density, so that the modulus at the mean density would be too small. That of a node
 * is the mean by volume of the elements' moduli at it, by their own polynomials. Where the law is of the other density
 * than the mesh, ash = 0.598 apparent (`schileo2008` of \ref DensityCalibration); mass density is apparent density. A
 * bin has the mean of its elements' moduli by volume.
 *
 * Element sets: REGION_1, ... and MAT_1, ... (softest first). Node sets: BOUNDARY; INTERFACE_2 between region 1 and 2,
 * and so on; CUT_1, ... (flat cuts, largest first); END_LOW_X to END_HIGH_Z, within 3 % of the extent from either end
 * along each axis; LM_NAME, the corner next to a landmark, whose name keeps letters, digits and underscores and has
 * underscores for the rest.
 *
 * Throws std::invalid_argument where the mesh holds no density or one of another quantity, a parameter is out of its
 * range, two landmarks' sets have one name, or a landmark lies further than FarthestLandmark from the mesh. */
FiniteElementModel
MakeFiniteElements(const MeshArrays &              mesh,
                   const ElasticityLaw &           law,
                   const FiniteElementParameters & parameters = FiniteElementParameters(),
                   const std::vector<Landmark> &   landmarks = {});
} // namespace bone

#endif
