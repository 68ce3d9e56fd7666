/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasRegistration_h
#define boneAtlasRegistration_h

#include "boneReflection.h"
#include "boneTriangleSurface.h"
#include "boneUntangling.h"

#include <memory>

namespace bone
{
class InteriorDeformation;
struct RegistrationParameters;

/** What a registration did. */
struct RegistrationReport
{
  AffineMap alignment;                ///< standard -> subject (reflected, where mirrored)
  double    alignmentDistance{ 0.0 }; ///< root mean square of the pairs that count, mm
  bool      mirrored{ false };        ///< the subject was reflected at x = 0 first, and the result lies there
  double    surfaceDistance{ 0.0 };   ///< mean distance of the model's exterior points to the subject, mm
  double    subjectDistance{ 0.0 };   ///< mean distance of the subject's points to the model, mm
  /** Mean distance of the points of each surface between layers to the subject's, mm; -1 where the subject has none. */
  std::vector<double> layerDistance;
  UntanglingReport    untangling;
};

/** A subject's surfaces. */
struct SubjectSurfaces
{
  TriangleSurface exterior;
  /** inner[k]: the boundary of the regions from k + 2 inward; empty where they are not there. */
  std::vector<TriangleSurface> inner;
};

/** All surfaces of a layered mesh. */
SubjectSurfaces
SurfacesOf(const MeshArrays & mesh);

/** \class StandardModel
 * \brief A tetrahedral mesh that is carried to subjects (paper 6.1); what depends on it alone is computed once.
 *
 * Const use is safe from many threads. */
class StandardModel
{
public:
  /** Takes points, tetrahedra, regions and neighbours (computed where absent). Throws std::invalid_argument where there
   * are no tetrahedra, or flat or inverted ones. */
  explicit StandardModel(const MeshArrays & mesh);
  ~StandardModel();

  /** The mesh's points on the subject, and what was done. Surfaces between layers are laid on the subject's where it
   * gives them; else interior points follow the exterior. Throws std::invalid_argument where the subject has no
   * surface, std::runtime_error with their number where tetrahedra are left inverted. */
  std::vector<Vector3>
  Register(const SubjectSurfaces &             subject,
           const AtlasRegistrationParameters & parameters,
           RegistrationReport &                report,
           const Execution &                   execution = {}) const;

  const TriangleSurface &
  GetSurface() const
  {
    return m_Surface;
  }
  /** The mesh's ids of the surface's points. */
  const std::vector<IdType> &
  GetSurfacePointIds() const
  {
    return m_SurfaceId;
  }

private:
  /** A surface between layers and the mesh's ids of its points. */
  struct LayerSurface
  {
    TriangleSurface     surface;
    std::vector<IdType> id;
    std::vector<char>   exterior; ///< marks its points that are exterior
  };

  void
  FitLayers(const std::vector<TriangleSurface> & target,
            const RegistrationParameters &       parameters,
            const AffineMap &                    alignment,
            std::vector<Vector3> &               points,
            RegistrationReport &                 report,
            const Execution &                    execution) const;

  MeshArrays                           m_Mesh;
  std::vector<IdType>                  m_SurfaceId;
  TriangleSurface                      m_Surface;
  std::vector<LayerSurface>            m_Layers;
  std::vector<IdType>                  m_FixedId; ///< exterior points and those of surfaces between layers
  std::unique_ptr<InteriorDeformation> m_Interior;
  std::unique_ptr<InteriorDeformation> m_BetweenLayers; ///< with m_FixedId given
};
} // namespace bone

#endif
