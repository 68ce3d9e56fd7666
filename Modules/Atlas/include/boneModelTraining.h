/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneModelTraining_h
#define boneModelTraining_h

#include "boneExecution.h"
#include "boneStatisticalModel.h"
#include "boneStatisticalModelParameters.h"
#include "boneTrainingSet.h"

namespace bone
{
/** How far each subject is from the mean. */
struct SubjectDeviation
{
  std::string name;
  double      shape{ 0.0 };        ///< root mean square distance of points to the mean, mm
  double      density{ 0.0 };      ///< root mean square difference of coefficients to the mean, density units
  double      shapeScore{ 0.0 };   ///< modified z-score of the former among all subjects
  double      densityScore{ 0.0 }; ///< and of the latter
  bool        outlier{ false };    ///< a score is above the threshold
  bool        used{ true };        ///< in the model
};

/** A trained model and how its subjects lie. */
struct TrainingResult
{
  StatisticalModelContent       content;
  std::vector<SubjectDeviation> subjects;
};

/** \brief The kernel of \ref StatisticalModelEstimator.
 *
 * `former`: an atlas that the subjects are added to, whose inner product of densities, kind of alignment where it is by
 * similarity, and mean pose are kept; where it is given one subject is enough. Throws itk::ExceptionObject. */
TrainingResult
TrainModel(const TrainingSet &                set,
           const StatisticalModelParameters & parameters,
           const Execution &                  execution = {},
           const StatisticalModelContent *    former = nullptr);

/** Modified z-scores 0.6745 (x - median) / median |x - median| (Iglewicz & Hoaglin 1993); 0 where all are equal. */
std::vector<double>
ModifiedScores(const std::vector<double> & values);
} // namespace bone

#endif
