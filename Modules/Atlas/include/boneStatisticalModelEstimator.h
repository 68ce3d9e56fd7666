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
 * Input: a \ref TrainingSet of meshes on one topology with density of one degree and quantity, or none; SetInput of
 * meshes is AddSubject of \ref MeshTrainingSet. Output: \ref StatisticalModel.
 *
 * Shapes are brought together by generalised Procrustes analysis (\ref AlignShapes), in the mean of the subjects' own
 * frames. Principal modes of the stacked coordinates and, apart from them, of the stacked Bernstein coefficients come
 * from the matrix of inner products between subjects, in double (\ref AnalyzeVectors). Subjects' densities are read in
 * turn; only shapes, a block of densities and the modes are in memory.
 *
 * Parameters:
 * - Alignment: None, Rigid (default) or Similarity, which takes size out of the shape modes.
 * - VarianceProportion: the modes kept explain at least this share of the variance of shape, and of density; 0..1,
 *   default 0.98; 1 keeps full rank.
 * - MaximumModes: of each; default 0, no limit.
 * - Combined: also Cootes' combined model of both; default off, as in the paper.
 * - VolumeWeighted: inner product of densities by their integral over the mean mesh, so that cells count by their
 * volume and modes are those of the density as a function, whatever its degree; default off: each coefficient counts
 * alike, as in the paper.
 * - WithinCellWeight: with VolumeWeighted, how much the density's variation within a cell counts against its mean
 * there; above 0, at most 1, which makes the product the integral itself; default 0.25, as most of it is the scanner's
 * blur at the layers' surfaces and what is left of the registration's error, which differ from subject to subject.
 * - OutlierThreshold: modified z-score of a subject's distance to the mean, in shape or density, above which it is
 * called an outlier; default 3.5, 0: none are. RejectOutliers: train again without them; default off.
 * - BlockBytes: memory for densities held at once; default 1 GiB. Does not change results beyond rounding.
 *
 * Results do not depend on the number of threads. Throws itk::ExceptionObject where there are fewer than two subjects,
 * one has another topology, degree or quantity than the first, or a parameter is out of range. */
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

  using Superclass::SetInput;
  void
  SetInput(const TrainingSet * set);
  const TrainingSet *
  GetInput() const;
  StatisticalModel *
  GetOutput();
  const StatisticalModel *
  GetOutput() const;

  itkSetEnumMacro(Alignment, AlignmentKind);
  itkGetEnumMacro(Alignment, AlignmentKind);
  itkSetMacro(VarianceProportion, double);
  itkGetConstMacro(VarianceProportion, double);
  itkSetMacro(MaximumModes, int);
  itkGetConstMacro(MaximumModes, int);
  itkSetMacro(Combined, bool);
  itkGetConstMacro(Combined, bool);
  itkBooleanMacro(Combined);
  itkSetMacro(VolumeWeighted, bool);
  itkGetConstMacro(VolumeWeighted, bool);
  itkBooleanMacro(VolumeWeighted);
  itkSetMacro(WithinCellWeight, double);
  itkGetConstMacro(WithinCellWeight, double);
  itkSetMacro(OutlierThreshold, double);
  itkGetConstMacro(OutlierThreshold, double);
  itkSetMacro(RejectOutliers, bool);
  itkGetConstMacro(RejectOutliers, bool);
  itkBooleanMacro(RejectOutliers);
  itkSetMacro(BlockBytes, std::size_t);
  itkGetConstMacro(BlockBytes, std::size_t);

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
  VerifyPreconditions() ITKv5_CONST override;
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  AlignmentKind                 m_Alignment{ AlignmentKind::Rigid };
  double                        m_VarianceProportion{ 0.98 };
  int                           m_MaximumModes{ 0 };
  bool                          m_Combined{ false };
  bool                          m_VolumeWeighted{ false };
  double                        m_WithinCellWeight{ 0.25 };
  double                        m_OutlierThreshold{ 3.5 };
  bool                          m_RejectOutliers{ false };
  std::size_t                   m_BlockBytes{ std::size_t(1) << 30 };
  std::vector<SubjectDeviation> m_Deviations;
};

extern template class StatisticalModelEstimator<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneStatisticalModelEstimator.hxx"
#endif

#endif
