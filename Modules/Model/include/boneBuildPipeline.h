/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildPipeline_h
#define boneBuildPipeline_h

#include "boneBuildParameters.h"
#include "boneHierarchyLevelFilter.h"
#include "boneImageIO.h"

#include "boneContourResampleFilter.h"
#include "boneContourSliceFilter.h"
#include "boneContourTilingMeshSource.h"
#include "boneDRRImageFilter.h"
#include "boneDensityFitFilter.h"
#include "boneMedialAxisFilter.h"
#include "boneMeshQualityFilter.h"
#include "bonePlacementFilter.h"
#include "boneSnakeContourFilter.h"
#include "boneTetraCollapseFilter.h"

#include <string>
#include <utility>
#include <vector>

namespace bone
{
/** What the tiling left out, in words; empty where it is all of the contours. */
std::vector<std::string>
DescribeLosses(const TilingReport & report);

/** \class BuildPipeline
 * \brief The whole job as one lazy ITK pipeline: from a CT to radiographs of each level of its density model.
 *
 * CT, labels or contours -> snake contours -> slices kept -> resampled contours -> medial axes -> tiling -> mesh
 * quality -> density fit
 * -> collapse -> one radiograph a level. Parameters are set on the stages; an update runs the stages whose input or
 * parameters changed and those after them, and no others.
 *
 * The stages may work in a space of their own (\ref OnOwnGrid): SetPlacement says where that lies, and GetContours,
 * GetHierarchy and the radiographs are in their place, while the outputs of the stages are not. */
class BuildPipeline
{
public:
  using MeshType = DensityMesh<double>;
  using SnakeType = SnakeContourFilter<CTImage>;
  using SlicesType = ContourSliceFilter;
  using ResampleType = ContourResampleFilter;
  using MedialAxisType = MedialAxisFilter;
  using TilingType = ContourTilingMeshSource<MeshType>;
  using QualityType = MeshQualityFilter<MeshType>;
  using FitType = DensityFitFilter<CTImage, MeshType>;
  using CollapseType = TetraCollapseFilter<MeshType>;
  using RadiographType = DRRImageFilter<MeshType, CTImage>;

  /** A stage and its name for people. */
  using Stage = std::pair<std::string, itk::ProcessObject *>;

  /** \param numberOfLevels  with the first one; their numbers of tetrahedra are set on the collapse. */
  explicit BuildPipeline(std::size_t numberOfLevels);

  /** \name Inputs
   * The labels and the contours say where the bone is; one of them is required.
   * \{ */
  void
  SetImage(const CTImage * image);
  void
  SetLabelImage(const LabelImage * labels);
  void
  SetInitialContours(const ContourStack * contours);
  void
  SetGeometry(const XRayGeometry * geometry);
  /** Where the space of images and contours lies; by default where they say. */
  void
  SetPlacement(const Placement & placement);
  /** \} */

  /** Sets the parameters of all stages; those of the plan are its own affair (\ref PlanBuild). */
  void
  SetParameters(const BuildParameters & parameters);
  /** The parameters of all stages as they are; the plan's are left as they come. */
  void
  GetParameters(BuildParameters & parameters) const;

  /** Largest spacing (mm) of the contours' samples on a slice; where they curve they are closer: a third of it at
   * least, and with a tolerance that goes with its square, so that the number of samples goes with its inverse. */
  void
  SetContourSpacing(double spacing);

  /** \name Stages
   * \{ */
  SnakeType *
  GetSnake() const
  {
    return m_Snake;
  }
  /** Which slices are kept; all of the snake's by default. */
  SlicesType *
  GetSlices() const
  {
    return m_Slices;
  }
  ResampleType *
  GetResample() const
  {
    return m_Resample;
  }
  MedialAxisType *
  GetMedialAxis() const
  {
    return m_MedialAxis;
  }
  TilingType *
  GetTiling() const
  {
    return m_Tiling;
  }
  QualityType *
  GetQuality() const
  {
    return m_Quality;
  }
  FitType *
  GetFit() const
  {
    return m_Fit;
  }
  CollapseType *
  GetCollapse() const
  {
    return m_Collapse;
  }
  RadiographType *
  GetRadiograph(std::size_t level) const
  {
    return m_Radiographs.at(level);
  }
  std::size_t
  GetNumberOfLevels() const
  {
    return m_Radiographs.size();
  }
  /** All of them in order; those that differ by level have the level in their name. */
  std::vector<Stage>
  GetStages() const;
  /** \} */

  /** \name Results in their place; up to date after an update of theirs
   * \{ */
  ContourStack *
  GetContours() const
  {
    return m_PlacedContours->GetOutput();
  }
  DensityHierarchy<> *
  GetHierarchy() const
  {
    return m_PlacedHierarchy->GetOutput();
  }
  /** The first level, which is known before the others: a mesh of its own. Brings the density fit up to date. */
  MeshType::Pointer
  GetFinest();
  /** The density of a level whose gradient is continuous within regions (\ref SplitWorseyFarin), fitted to the image
   * where the fit's parameters have ContinuousGradient; null where they have not. The hierarchy is without it, as
   * levels are simplified from tetrahedra that are not split. Brings itself up to date. */
  MeshType::Pointer
  GetSpline(std::size_t level);
  /** The stage that makes it. */
  FitType *
  GetSplineFit(std::size_t level) const
  {
    return m_SplineFits.at(level);
  }
  /** \} */

  /** Brings everything up to date, but for splines. */
  void
  Update();

  /** What a person should know of the contours and the tiling, after an update of the tiling. */
  std::vector<std::string>
  GetWarnings() const;

private:
  /** The fit's mesh in its place, up to date. */
  MeshType::Pointer
  PlacedMeshOf(FitType * fit) const;

  SnakeType::Pointer      m_Snake{ SnakeType::New() };
  SlicesType::Pointer     m_Slices{ SlicesType::New() };
  ResampleType::Pointer   m_Resample{ ResampleType::New() };
  MedialAxisType::Pointer m_MedialAxis{ MedialAxisType::New() };
  TilingType::Pointer     m_Tiling{ TilingType::New() };
  QualityType::Pointer    m_Quality{ QualityType::New() };
  FitType::Pointer        m_Fit{ FitType::New() };
  CollapseType::Pointer   m_Collapse{ CollapseType::New() };
  using PlacedContoursType = PlacementFilter<ContourStack>;
  using PlacedHierarchyType = PlacementFilter<DensityHierarchy<>>;
  PlacedContoursType::Pointer                m_PlacedContours{ PlacedContoursType::New() };
  PlacedHierarchyType::Pointer               m_PlacedHierarchy{ PlacedHierarchyType::New() };
  std::vector<HierarchyLevelFilter::Pointer> m_Levels;
  std::vector<RadiographType::Pointer>       m_Radiographs;
  std::vector<HierarchyLevelFilter::Pointer> m_OwnLevels; // not in their place
  std::vector<FitType::Pointer>              m_SplineFits;
};
} // namespace bone

#endif
