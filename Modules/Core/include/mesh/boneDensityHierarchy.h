/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityHierarchy_h
#define boneDensityHierarchy_h

#include "boneDensityMesh.h"
#include "boneXRayGeometry.h"

#include <Eigen/Geometry>
#include <itkDataObject.h>
#include <itkObjectFactory.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace bone
{
/** \class DensityHierarchy
 * \brief Levels of one density model from fine to coarse (paper 4); a level's points are a subset of the level before.
 */
template <typename TMesh = DensityMesh<double>>
class DensityHierarchy : public itk::DataObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DensityHierarchy);
  using Self = DensityHierarchy;
  using Superclass = itk::DataObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DensityHierarchy, itk::DataObject);

  using MeshType = TMesh;

  /** One level and how it was made. */
  struct Level
  {
    typename TMesh::Pointer mesh;
    /** Id in the level before of each point; empty for the first level. */
    std::vector<IdType> parentPoint;
    /** Bound asked for on the density error, in density units; negative: none. */
    double densityErrorBound{ -1.0 };
    /** Root mean square density difference to the first level, in density units (paper 4.3). */
    double densityError{ 0.0 };
    /** Largest distance of boundary and interfaces to those of the first level, or back, mm. */
    double surfaceError{ 0.0 };
    /** Why the simplification of this level ended ("tetrahedra reached", "density error bound", ...). */
    std::string stopReason;
  };

  itkGetConstReferenceMacro(Levels, std::vector<Level>);
  void
  SetLevels(std::vector<Level> levels)
  {
    m_Levels = std::move(levels);
    this->Modified();
  }
  std::size_t
  GetNumberOfLevels() const
  {
    return m_Levels.size();
  }
  const TMesh *
  GetMesh(std::size_t level) const
  {
    return m_Levels.at(level).mesh;
  }

  /** \defgroup PickLevel Which level to use, as its index; 0 is the finest. They need at least one level.
   * \{ */
  /** The finest level of no more than so many tetrahedra; the coarsest where all have more. */
  std::size_t
  PickByCount(IdType tetrahedra) const
  {
    std::size_t level = 0;
    while (level + 1 < m_Levels.size() && m_Levels[level].mesh->GetNumberOfTetrahedra() > tetrahedra)
    {
      ++level;
    }
    return level;
  }
  /** The coarsest level whose errors are no more than these (density units, mm). */
  std::size_t
  PickByError(double densityError, double surfaceError = std::numeric_limits<double>::infinity()) const
  {
    std::size_t level = m_Levels.size() - 1;
    while (level > 0 && (m_Levels[level].densityError > densityError || m_Levels[level].surfaceError > surfaceError))
    {
      --level;
    }
    return level;
  }
  /** The coarsest level whose surfaces are nowhere away from those of the first by more than so many pixels of a view,
   * at the magnification of the part of the model that is nearest to the source. */
  std::size_t
  PickByPixelSize(const XRayGeometry & geometry, double pixels = 1.0) const
  {
    const auto &  view = geometry.GetView();
    const Vector3 normal = view.detectorU.cross(view.detectorV);
    double        magnification = 1.0;
    const auto    arrays = m_Levels.at(0).mesh->GetArrays();
    for (const Vector3 & x : view.parallel ? std::vector<Vector3>() : arrays.points)
    {
      const double depth = std::abs((x - view.source).dot(normal));
      magnification = std::max(magnification, std::abs((view.detectorOrigin - view.source).dot(normal)) / depth);
    }
    return this->PickByError(std::numeric_limits<double>::infinity(),
                             pixels * std::min(view.spacing[0], view.spacing[1]) / magnification);
  }
  /** \} */

  void
  Initialize() override
  {
    Superclass::Initialize();
    m_Levels.clear();
  }
  void
  Graft(const itk::DataObject * data) override
  {
    const auto * other = dynamic_cast<const Self *>(data);
    if (data != nullptr && other == nullptr)
    {
      itkExceptionMacro("Cannot graft a " << data->GetNameOfClass() << " onto a DensityHierarchy.");
    }
    Superclass::Graft(data);
    if (other != nullptr)
    {
      m_Levels = other->m_Levels;
    }
  }

protected:
  DensityHierarchy() = default;
  ~DensityHierarchy() override = default;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override
  {
    Superclass::PrintSelf(os, indent);
    for (std::size_t i = 0; i < m_Levels.size(); ++i)
    {
      os << indent << "Level " << i + 1 << ": " << m_Levels[i].mesh->GetNumberOfTetrahedra() << " tetrahedra\n";
    }
  }

private:
  std::vector<Level> m_Levels;
};
} // namespace bone

#endif
