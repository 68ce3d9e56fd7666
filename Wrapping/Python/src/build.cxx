/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "filters.h"

#include "boneBuildPlan.h"

namespace bone::python
{
namespace
{
/** Sets a build's parameter: one of the plan or of the stages, of which the first that has it takes it. */
void
SetBuildParameter(BuildParameters & parameters, const std::string & name, const py::handle & value)
{
  bool found = false;
  BuildParameters::Visit(parameters,
                         [&](const char *, auto & stage) { found = found || SetParameterByName(stage, name, value); });
  if (!found)
  {
    throw UsageFailure("a build has no parameter \"" + name + '"');
  }
}

/** The stages of a build tell one function how far all of it is. */
class BuildProgress
{
public:
  BuildProgress(BuildPipeline & pipeline, const py::object & function)
    : m_Stages(pipeline.GetStages())
    , m_Function(function)
  {
    for (const auto & stage : m_Stages)
    {
      m_Tags.push_back(stage.second->AddObserver(itk::ProgressEvent(),
                                                 [this, stage](const itk::EventObject &) { this->Tell(stage); }));
    }
  }
  BuildProgress(const BuildProgress &) = delete;
  BuildProgress &
  operator=(const BuildProgress &) = delete;
  ~BuildProgress()
  {
    for (std::size_t i = 0; i < m_Tags.size(); ++i)
    {
      m_Stages[i].second->RemoveObserver(m_Tags[i]);
    }
  }
  /** Raises what the function, or Ctrl-C, raised. */
  void
  Raise()
  {
    if (m_Error)
    {
      throw *m_Error;
    }
  }

private:
  void
  Tell(const BuildPipeline::Stage & stage)
  {
    const py::gil_scoped_acquire acquire;
    if (m_Error)
    {
      stage.second->SetAbortGenerateData(true);
      return;
    }
    try
    {
      if (PyErr_CheckSignals() != 0)
      {
        throw py::error_already_set();
      }
      if (!m_Function.is_none())
      {
        m_Function(stage.first, static_cast<double>(stage.second->GetProgress()));
      }
    }
    catch (const py::error_already_set & error)
    {
      m_Error = std::make_unique<py::error_already_set>(error);
      stage.second->SetAbortGenerateData(true);
    }
  }

  std::vector<BuildPipeline::Stage>      m_Stages;
  std::vector<unsigned long>             m_Tags;
  py::object                             m_Function;
  std::unique_ptr<py::error_already_set> m_Error;
};

DensityHierarchy<>::Pointer
Build(const py::object & image,
      const py::object & labels,
      ContourStack *     contours,
      const py::object & progress,
      const py::kwargs & keywords)
{
  BuildParameters parameters;
  for (const auto & item : keywords)
  {
    SetBuildParameter(parameters, item.first.cast<std::string>(), item.second);
  }
  if (parameters.fit.continuousGradient)
  {
    throw UsageFailure(
      "build gives levels, whose tetrahedra are not split: give a level to fit, with continuous_gradient");
  }
  const CTImage::Pointer    ct = ToCT(ToImage(image));
  const LabelImage::Pointer map = labels.is_none() ? nullptr : ToLabels(ToImage(labels));
  if (!map && contours == nullptr)
  {
    throw UsageFailure("labels or contours must say where the bone is");
  }
  BuildPipeline               pipeline(parameters.plan.levels.size() + 1);
  BuildProgress               listener(pipeline, progress);
  DensityHierarchy<>::Pointer hierarchy;
  try
  {
    const py::gil_scoped_release release;
    const BuildInput             input = CropToBone(ct, map, contours, parameters.plan);
    PlanBuild(input, parameters, pipeline);
    FinishBuild(parameters.plan, nullptr, pipeline);
    hierarchy = pipeline.GetHierarchy();
    hierarchy->DisconnectPipeline();
    for (const auto & level : hierarchy->GetLevels())
    {
      level.mesh->DisconnectPipeline();
    }
  }
  catch (...)
  {
    listener.Raise();
    throw;
  }
  listener.Raise();
  return hierarchy;
}

py::dict
ListBuildParameters()
{
  py::dict        result;
  BuildParameters parameters;
  BuildParameters::Visit(parameters, [&result](const char *, auto & stage) {
    for (const auto & entry : ListParameters<std::decay_t<decltype(stage)>>())
    {
      if (!result.contains(entry.name.c_str()))
      {
        result[py::str(entry.name)] = entry.help;
      }
    }
  });
  return result;
}
} // namespace

void
BindBuild(py::module_ & m)
{
  m.def("_build", &Build, py::arg("image"), py::arg("labels"), py::arg("contours"), py::arg("progress"));
  m.def("_build_parameters", &ListBuildParameters, "Name and help of each.");
}
} // namespace bone::python
