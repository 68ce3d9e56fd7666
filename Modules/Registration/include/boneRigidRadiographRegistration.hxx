/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidRadiographRegistration_hxx
#define boneRigidRadiographRegistration_hxx

#include "boneMeshRadiograph.h"
#include "boneRigidRadiographRegistration.h"

#include <itkImageRegionConstIterator.h>

namespace bone
{
template <typename TMesh, typename TImage>
RigidRadiographRegistration<TMesh, TImage>::RigidRadiographRegistration()
{
  this->AddRequiredInputName("Model");
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::SetView(unsigned int         view,
                                                    const TImage *       radiograph,
                                                    const XRayGeometry * geometry,
                                                    const TImage *       weights)
{
  this->ProcessObject::SetInput(NameOf("Radiograph", view), const_cast<TImage *>(radiograph));
  this->ProcessObject::SetInput(NameOf("Geometry", view), const_cast<XRayGeometry *>(geometry));
  this->ProcessObject::SetInput(NameOf("Weights", view), const_cast<TImage *>(weights));
}

template <typename TMesh, typename TImage>
unsigned int
RigidRadiographRegistration<TMesh, TImage>::GetNumberOfViews() const
{
  unsigned int views = 0;
  while (this->GetOfView<TImage>("Radiograph", views) != nullptr ||
         this->GetOfView<XRayGeometry>("Geometry", views) != nullptr)
  {
    ++views;
  }
  return views;
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  if (this->GetNumberOfViews() == 0)
  {
    itkExceptionMacro("There is no X-ray: set view 0, an image and its geometry.");
  }
  for (unsigned int v = 0; v < this->GetNumberOfViews(); ++v)
  {
    if (this->GetOfView<TImage>("Radiograph", v) == nullptr || this->GetOfView<XRayGeometry>("Geometry", v) == nullptr)
    {
      itkExceptionMacro("View " << v + 1 << " needs both an image and a geometry.");
    }
  }
}

template <typename TMesh, typename TImage>
std::vector<float>
RigidRadiographRegistration<TMesh, TImage>::CopyPixels(const char * what, unsigned int view) const
{
  const TImage * image = this->GetOfView<TImage>(what, view);
  if (image == nullptr)
  {
    return {};
  }
  const auto   region = image->GetBufferedRegion();
  const auto & size = this->GetOfView<XRayGeometry>("Geometry", view)->GetView().size;
  if (region.GetSize(0) != static_cast<itk::SizeValueType>(size[0]) ||
      region.GetSize(1) != static_cast<itk::SizeValueType>(size[1]) || region.GetSize(2) != 1)
  {
    itkExceptionMacro("View " << view + 1 << ": the input '" << NameOf(what, view) << "' has " << region.GetSize(0)
                              << " x " << region.GetSize(1) << " x " << region.GetSize(2) << " pixels, its geometry "
                              << size[0] << " x " << size[1] << " x 1.");
  }
  std::vector<float> pixels;
  pixels.reserve(region.GetNumberOfPixels());
  for (itk::ImageRegionConstIterator<TImage> it(image, region); !it.IsAtEnd(); ++it)
  {
    pixels.push_back(static_cast<float>(it.Get()));
  }
  return pixels;
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::GenerateData()
{
  const HierarchyType *   model = this->GetModel();
  std::vector<MeshArrays> levels;
  for (std::size_t i = 0; i < model->GetNumberOfLevels(); ++i)
  {
    levels.push_back(model->GetMesh(i)->GetArrays());
    const std::string obstacle =
      FindObstacle(levels.back().points, levels.back(), MeshRadiographParameters{}, HUToAttenuation::None);
    if (!obstacle.empty())
    {
      itkExceptionMacro("Level " << i + 1 << " of the input 'Model': " << obstacle);
    }
  }
  if (levels.empty())
  {
    itkExceptionMacro("The input 'Model' has no level.");
  }
  std::vector<RadiographView> views;
  for (unsigned int v = 0; v < this->GetNumberOfViews(); ++v)
  {
    views.push_back({ this->GetOfView<XRayGeometry>("Geometry", v)->GetView(),
                      this->CopyPixels("Radiograph", v),
                      this->CopyPixels("Weights", v) });
    for (std::size_t i = 0; i < views[v].values.size(); ++i)
    {
      const float weight = views[v].weights.empty() ? 1.0f : views[v].weights[i];
      if (!(weight >= 0.0f && weight <= 1.0f) || (weight > 0.0f && !std::isfinite(views[v].values[i])))
      {
        itkExceptionMacro("View " << v + 1 << ": pixel " << i % views[v].view.size[0] << ' '
                                  << i / views[v].view.size[0]
                                  << " is not finite, or its weight is not from 0 to 1: give it the weight 0.");
      }
    }
  }
  const TransformType * initial = this->GetInitialTransform();
  try
  {
    m_Result = RegisterRigid(levels,
                             views,
                             initial != nullptr ? RigidPose::FromTransform(*initial) : RigidPose(),
                             this->GetParameters(),
                             Execution(this),
                             [this](const RigidPose & pose, double cost) {
                               m_CurrentPose = pose;
                               m_CurrentCost = cost;
                               this->InvokeEvent(itk::IterationEvent());
                             });
  }
  catch (const std::invalid_argument & error)
  {
    itkExceptionMacro("" << error.what());
  }
  this->GetOutput()->Set(m_Result.pose.ToTransform());
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
  os << indent << "Quality: " << ParameterText(m_Result.quality) << '\n';
  os << indent << "Distinctness: " << m_Result.distinctness << '\n';
  os << indent << "CurrentCost: " << m_CurrentCost << '\n';
  os << indent << "CurrentPose: " << m_CurrentPose.translation.transpose() << '\n';
}
} // namespace bone

#endif
