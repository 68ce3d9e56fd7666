/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshDerivatives_h
#define boneMeshDerivatives_h

#include "boneProjectionModel.h"

namespace bone
{
/** Directions along which a radiograph is derived, in this order. */
struct RadiographModes
{
  /** Rigid motion of the mesh before a fixed source and detector: translation along x, y, z (per mm), then rotation
   * about axes along x, y, z through poseCentre (per radian, right-handed). */
  bool    pose{ false };
  Vector3 poseCentre{ Vector3::Zero() };
  /** Displacements of the mesh's points, mm per unit of each mode; the density moves with the tetrahedra. */
  std::vector<std::vector<Vector3>> shape;
  /** Changes of MeshCells::coefficients, laid out like these, per unit of each mode. */
  std::vector<std::vector<double>> density;

  std::size_t
  Count() const
  {
    return (pose ? 6 : 0) + shape.size() + density.size();
  }
};

/** \brief ProjectMesh with the image's derivatives, in the same pass over the tetrahedra.
 *
 * `images` are 1 + modes.Count() of rows x columns: the radiograph, then its derivative by each mode. Exact derivatives
 * of the integrals where the image has any: it has kinks at the projected edges, and jumps at faces of the outer
 * surface that are seen edge-on. Shape modes must have a displacement for each point, density modes a number for each
 * coefficient. Beside the output, memory is needed for one band of rows a thread, and for a displacement of each point
 * and shape mode.
 */
void
ProjectMeshDerivatives(const std::vector<Vector3> &     points,
                       const MeshCells &                cells,
                       const XRayGeometry::View &       view,
                       const MeshRadiographParameters & parameters,
                       const RadiographModes &          modes,
                       const Execution &                execution,
                       const std::vector<float *> &     images);

/** The same for a model that is kept. */
void
ProjectMeshDerivatives(const ProjectionModel &      model,
                       const XRayGeometry::View &   view,
                       const RadiographModes &      modes,
                       const Execution &            execution,
                       const std::vector<float *> & images);

/** \brief The adjoint: for f = sum over the pixels of image * ProjectMesh(...), the derivatives of f.
 *
 * `coefficients` receives df / dc for each of MeshCells::coefficients (0 for cells not selected; the projection being
 * linear, this is the transpose of the matrix from coefficients to pixels), `positions` (#points, or null) df / dx for
 * each point, per mm. The result does not depend on the number of threads. */
void
BackprojectToMesh(const std::vector<Vector3> &     points,
                  const MeshCells &                cells,
                  const XRayGeometry::View &       view,
                  const MeshRadiographParameters & parameters,
                  const Execution &                execution,
                  const float *                    image,
                  double *                         coefficients,
                  Vector3 *                        positions);

/** The same for a model that is kept. */
void
BackprojectToMesh(const ProjectionModel &    model,
                  const XRayGeometry::View & view,
                  const Execution &          execution,
                  const float *              image,
                  double *                   coefficients,
                  Vector3 *                  positions);
} // namespace bone

#endif
