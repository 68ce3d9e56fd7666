/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographRegistrationBase_hxx
#define boneRadiographRegistrationBase_hxx

#include "boneRadiographRegistrationBase.h"

#include <itkImageRegionConstIterator.h>

#include <cmath>

namespace bone
{
template <typename TImage>
void
RadiographRegistrationBase<TImage>::SetView(unsigned int         view,
                                            const TImage *       radiograph,
                                            const XRayGeometry * geometry,
                                            const TImage *       weights)
{
  this->ProcessObject::SetInput(NameOf("Radiograph", view), const_cast<TImage *>(radiograph));
  this->ProcessObject::SetInput(NameOf("Geometry", view), const_cast<XRayGeometry *>(geometry));
  this->ProcessObject::SetInput(NameOf("Weights", view), const_cast<TImage *>(weights));
}

template <typename TImage>
unsigned int
RadiographRegistrationBase<TImage>::GetNumberOfViews() const
{
  unsigned int views = 0;
  while (this->GetOfView<TImage>("Radiograph", views) != nullptr ||
         this->GetOfView<XRayGeometry>("Geometry", views) != nullptr)
  {
    ++views;
  }
  return views;
}

template <typename TImage>
void
RadiographRegistrationBase<TImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
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

template <typename TImage>
std::vector<float>
RadiographRegistrationBase<TImage>::CopyPixels(const char * what, unsigned int view) const
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

template <typename TImage>
void
RadiographRegistrationBase<TImage>::VerifyPixels(const RadiographView & xray, unsigned int view) const
{
  for (std::size_t i = 0; i < xray.values.size(); ++i)
  {
    const float weight = xray.weights.empty() ? 1.0f : xray.weights[i];
    if (!(weight >= 0.0f && weight <= 1.0f) || (weight > 0.0f && !std::isfinite(xray.values[i])))
    {
      itkExceptionMacro("View " << view + 1 << ": pixel " << i % xray.view.size[0] << ' ' << i / xray.view.size[0]
                                << " is not finite, or its weight is not from 0 to 1: give it the weight 0.");
    }
  }
}

template <typename TImage>
std::vector<RadiographView>
RadiographRegistrationBase<TImage>::CopyViews() const
{
  std::vector<RadiographView> views;
  for (unsigned int v = 0; v < this->GetNumberOfViews(); ++v)
  {
    views.push_back({ this->GetOfView<XRayGeometry>("Geometry", v)->GetView(),
                      this->CopyPixels("Radiograph", v),
                      this->CopyPixels("Weights", v) });
    this->VerifyPixels(views.back(), v);
  }
  return views;
}

template <typename TImage>
RigidPose
RadiographRegistrationBase<TImage>::GetInitialPose() const
{
  const TransformType * initial = this->GetInitialTransform();
  return initial != nullptr ? RigidPose::FromTransform(*initial) : RigidPose();
}

template <typename TImage>
void
RadiographRegistrationBase<TImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "CurrentCost: " << m_CurrentCost << '\n';
}
} // namespace bone

#endif
