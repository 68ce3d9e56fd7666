/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStatisticalModel_h
#define boneStatisticalModel_h

#include "boneMeshArrays.h"
#include "bonePrincipalModes.h"

#include <itkDataObject.h>
#include <itkObjectFactory.h>

#include <string>
#include <vector>

namespace bone
{
/** \struct CombinedModes
 * \brief Cootes' combined model: principal modes of the stacked coefficients (W b_s, b_d), in mm and density units.
 *
 * #ks shape and #kd density modes. W = shapeWeight for all shape coefficients: the square root of the total density
 * variance over the total shape variance, so that both count alike. */
struct CombinedModes
{
  Eigen::MatrixXd vectors;            ///< #ks + #kd by #k, orthonormal columns
  Eigen::VectorXd variances;          ///< #k, descending
  double          shapeWeight{ 1.0 }; ///< density units per mm
};

/** \struct StatisticalModelContent
 * \brief What a \ref StatisticalModel holds. */
struct StatisticalModelContent
{
  /** Mean shape (points, mm), topology and attributes, and mean density (coefficients) where there is one. */
  MeshArrays     mean;
  PrincipalModes shape;    ///< of (x1, y1, z1, x2, ...), mm
  PrincipalModes density;  ///< of the coefficients in the mesh's order; no entries: no density
  CombinedModes  combined; ///< no variances: shape and density are independent (paper 6.2)

  bool                     similarity{ false }; ///< sizes were brought to one in the alignment
  std::vector<std::string> subjects;            ///< names of the training set
  Eigen::MatrixXd          shapeScores;         ///< #subjects by #ks, standard deviations
  Eigen::MatrixXd          densityScores;       ///< #subjects by #kd, standard deviations
};

/** \class StatisticalModel
 * \brief The atlas: mean shape and density of a bone and their modes of variation on one topology (paper 6.2).
 *
 * Shape and density vary independently, as polynomials in barycentric coordinates do not depend on shape; or together,
 * by a combined model. */
class StatisticalModel : public itk::DataObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(StatisticalModel);
  using Self = StatisticalModel;
  using Superclass = itk::DataObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(StatisticalModel, itk::DataObject);

  /** Throws itk::ExceptionObject where lengths do not match. */
  void
  SetContent(StatisticalModelContent content);
  itkGetConstReferenceMacro(Content, StatisticalModelContent);
  bool
  HasDensity() const
  {
    return m_Content.density.GetDimension() > 0;
  }
  bool
  IsCombined() const
  {
    return m_Content.combined.variances.size() > 0;
  }

  /** The mesh of shape and density coefficients in standard deviations; those that are not given are 0. Throws
   * itk::ExceptionObject where there are too many. Large coefficients may invert tetrahedra, which is for the caller to
   * count (CountInverted). */
  MeshArrays
  Synthesize(const Eigen::VectorXd & shape, const Eigen::VectorXd & density = Eigen::VectorXd()) const;

  /** Shape and density coefficients of combined coefficients. Throws where the model is not combined. */
  void
  SplitCombined(const Eigen::VectorXd & combined, Eigen::VectorXd & shape, Eigen::VectorXd & density) const;

  /** Combined coefficients of shape and density coefficients: the nearest of the combined model. */
  Eigen::VectorXd
  JoinCombined(const Eigen::VectorXd & shape, const Eigen::VectorXd & density) const;

  void
  Initialize() override;
  void
  Graft(const itk::DataObject * data) override;

protected:
  StatisticalModel() = default;
  ~StatisticalModel() override = default;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  StatisticalModelContent m_Content;
};

/** Points as one vector (x1, y1, z1, x2, ...), and back. */
Eigen::VectorXd
StackPoints(const std::vector<Vector3> & points);
std::vector<Vector3>
UnstackPoints(const Eigen::VectorXd & stacked);
} // namespace bone

#endif
