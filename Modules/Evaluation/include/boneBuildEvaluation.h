/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildEvaluation_h
#define boneBuildEvaluation_h

#include "boneBuildReport.h"
#include "bonePictures.h"

#include <future>
#include <memory>
#include <optional>

namespace bone
{
/** What a model is compared with. */
struct Evidence
{
  CTImage::ConstPointer    ct;
  LabelImage::ConstPointer mask; ///< not 0 in the bone; null: the voxels inside the model's finest level
  /** The CT as it is in its file, where `ct` is a part of it: the pictures tell its slices; null: `ct` is all. */
  itk::ImageBase<3>::ConstPointer whole;
};

/** A picture as a file has it, and as a page has it. */
struct EncodedPicture
{
  std::string png;
  std::string jpeg;
};

/** What takes long of a build's page. */
struct BuildPageParts
{
  nlohmann::json      finest;       ///< \ref PackLevel
  nlohmann::json      slices;       ///< \ref PackSlices
  std::vector<double> lowerDegrees; ///< of the finest level, see \ref LowerDegreeErrors
};

/** The measurements of a built model and the pictures made on the way. */
struct Evaluation
{
  std::vector<LevelReport>      levels;
  EncodedPicture                slices;      ///< of the CT with contours
  EncodedPicture                cutPlane;    ///< the CT and the levels in the plane of the bone's largest extent
  EncodedPicture                radiographs; ///< of the CT and the levels, in the pipeline's view and from the side
  std::optional<BuildPageParts> page;        ///< where one was asked for
};

/** \class BuildEvaluator
 * \brief Compares each level of a build with the CT, by volume, surface, density and radiograph.
 *
 * Most of the work is the finest level's. It begins when that is fitted, beside the collapse, which leaves processors
 * idle: on a thread of its own, unless ITK's default number of threads is one. What is found does not depend on that.
 * The radiograph of the CT counts the mask's voxels only.
 *
 * \code
 *   PlanBuild(input, parameters, pipeline);
 *   BuildEvaluator   evaluator(evidence, true, pipeline);
 *   FinishBuild(plan, nullptr, pipeline);
 *   const Evaluation evaluation = evaluator.Finish();
 * \endcode */
class BuildEvaluator
{
public:
  /** Brings the density fit up to date. \param pipeline  must outlive this
   *  \param page  whether \ref MakeBuildPage is to follow */
  BuildEvaluator(const Evidence & evidence, bool page, BuildPipeline & pipeline);
  /** Waits for the thread. */
  ~BuildEvaluator();
  BuildEvaluator(const BuildEvaluator &) = delete;
  BuildEvaluator &
  operator=(const BuildEvaluator &) = delete;

  /** When the pipeline is up to date, once. Throws what the work threw. */
  Evaluation
  Finish();

private:
  struct Begun;

  BuildPipeline &                     m_Pipeline;
  std::future<std::unique_ptr<Begun>> m_Begun;
};
} // namespace bone

#endif
