/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStatisticalModelEstimator_h
#define boneStatisticalModelEstimator_h

#include "boneModelTraining.h"

#include <itkProcessObject.h>

namespace bone
{
/** \class StatisticalModelEstimator
 * \brief Mean and modes of variation of shape and density of a training set (paper 6.2).
 *
 * Inputs: subjects on one topology with density of one degree and quantity, or none. Either meshes, each an input of
 * the pipeline (AddSubject): they are updated with the estimator, which runs again where one of them has changed; or
 * "TrainingSet" (SetInput), which gives out its subjects one at a time, for populations that do not fit in memory.
 * Output: \ref StatisticalModel.
 *
 * Shapes are brought together by generalised Procrustes analysis, in the mean of the subjects' own frames. Principal
 * modes of the stacked coordinates and, apart from them, of the stacked Bernstein coefficients are accumulated in
 * double, in passes over the subjects that are linear in their number and in the memory that Memory gives. They are
 * exact where all subjects fit; beyond, where the population varies in no more directions than are held, and nearly so
 * for the leading modes elsewhere. With SetAtlas() subjects are added to a model.
 *
 * Parameters: \ref StatisticalModelParameters. With Combined there is Cootes' combined model of both too. The
 * inner product of densities is their integral over the mean mesh, so that cells count by their volume and modes are
 * those of the density as a function, whatever its degree; with CoefficientProduct each coefficient counts alike, as in
 * the paper (6.2). WithinCellWeight is low by default, because most of the variation within a cell is the scanner's
 * blur at the layers' surfaces and what is left of the registration's error, which differ from subject to subject.
 *
 * Results do not depend on the number of threads. Throws itk::ExceptionObject where there are fewer than two subjects,
 * one has another topology, degree or quantity than the first or a
 * name that the atlas has already, or a parameter is out of range.
 *
 * \tparam TMesh a \ref DensityMesh, of double or float coordinates */
template <typename TMesh = DensityMesh<double>>
class StatisticalModelEstimator : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(StatisticalModelEstimator);
  using Self = StatisticalModelEstimator;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(StatisticalModelEstimator, itk::ProcessObject);

  using MeshType = TMesh;

  /** Adds a mesh to the subjects. Not together with a training set. */
  void
  AddSubject(const std::string & name, const TMesh * mesh);
  void
  RemoveSubjects();
  std::size_t
  GetNumberOfSubjects() const
  {
    return m_Names.size();
  }

  using Superclass::SetInput;
  void
  SetInput(const TrainingSet * set)
  {
    this->SetPrimaryInput(const_cast<TrainingSet *>(set));
  }
  const TrainingSet *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const TrainingSet *>(this->GetPrimaryInput());
  }
  /** \brief A model that the subjects are added to, without its own subjects; none: they are all there are.
   *
   * The model knows its subjects by their scores: what its modes leave out of them counts in the total variance alone.
   * New subjects are aligned to its mean, and the inner product of densities is its own. */
  itkSetInputMacro(Atlas, StatisticalModel);
  itkGetInputMacro(Atlas, StatisticalModel);

  StatisticalModel *
  GetOutput();
  const StatisticalModel *
  GetOutput() const;

  BONE_FILTER_PARAMETERS(StatisticalModelParameters, BONE_STATISTICAL_MODEL_PARAMETERS)

  /** After an update: each subject's distance to the mean, and who is an outlier. */
  const std::vector<SubjectDeviation> &
  GetSubjectDeviations() const
  {
    return m_Deviations;
  }

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  StatisticalModelEstimator();
  ~StatisticalModelEstimator() override = default;
  void
  VerifyPreconditions() const override;
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  /** The name of the input of subject i, counted from 0. */
  static std::string
  InputName(std::size_t i)
  {
    return "Subject" + std::to_string(i + 1);
  }

  std::vector<std::string>      m_Names;
  std::vector<SubjectDeviation> m_Deviations;
};

extern template class StatisticalModelEstimator<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneStatisticalModelEstimator.hxx"
#endif

#endif
