/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageFile.h"
#include "boneLabelIO.h"
#include "boneLabelValue.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <itkImageScanlineConstIterator.h>
#include <itkImageToImageFilter.h>
#include <itkVectorImage.h>
#include <itkVectorIndexSelectionCastImageFilter.h>

#include <algorithm>
#include <limits>

namespace bone
{
namespace
{
/** Whole numbers of a volume as labels, by the regions asked for. */
class LabelFilter : public itk::ImageToImageFilter<CTImage, LabelImage>
{
public:
  using Self = LabelFilter;
  using Superclass = itk::ImageToImageFilter<CTImage, LabelImage>;
  using Pointer = itk::SmartPointer<Self>;

  itkFactorylessNewMacro(Self);

  void
  SetPath(const std::string & path)
  {
    m_Path = path;
  }
  /** Which is kept for as long as this: an image does not keep its source. */
  void
  SetSource(VolumeSource * source)
  {
    m_Source = source;
    this->SetInput(source->GetOutput());
  }

protected:
  void
  GenerateOutputInformation() override
  {
    Superclass::GenerateOutputInformation();
    if (StatesOneBone(*this->GetInput()))
    {
      StateOneBone(*this->GetOutput());
    }
  }
  void
  GenerateData() override
  {
    const CTImage * values = this->GetInput();
    this->AllocateOutputs();
    const CTImage::RegionType region = this->GetOutput()->GetRequestedRegion();
    const auto                length = static_cast<std::size_t>(region.GetSize(0));
    LabelImage::PixelType *   label = this->GetOutput()->GetBufferPointer();
    for (itk::ImageScanlineConstIterator<CTImage> it(values, region); !it.IsAtEnd(); it.NextLine())
    {
      const float * row = values->GetBufferPointer() + values->ComputeOffset(it.GetIndex());
      for (std::size_t x = 0; x < length; ++x, ++label)
      {
        const bool inside = row[x] >= Limits::lowest() && row[x] <= Limits::max();
        *label = inside ? static_cast<LabelImage::PixelType>(row[x]) : LabelImage::PixelType{ 0 };
        if (!inside || static_cast<float>(*label) != row[x])
        {
          CTImage::IndexType index = it.GetIndex();
          index[0] += static_cast<itk::IndexValueType>(x);
          this->ThrowNoLabel(index);
        }
      }
    }
  }

private:
  using Limits = std::numeric_limits<LabelImage::PixelType>;

  [[noreturn]] void
  ThrowNoLabel(const CTImage::IndexType & index) const
  {
    RequireFinite(this->GetInput(), m_Path);
    throw IOError(m_Path,
                  Say("is no label map: its value at ",
                      index,
                      " is ",
                      this->GetInput()->GetPixel(index),
                      ", no whole number from ",
                      Limits::lowest(),
                      " to ",
                      Limits::max()));
  }

  std::string           m_Path;
  VolumeSource::Pointer m_Source;
};

LabelImage::Pointer
ToLabels(const CTImage * values, const std::string & path)
{
  const auto filter = LabelFilter::New();
  filter->SetPath(path);
  filter->SetInput(values);
  RequireSensibleGrid(values, path);
  filter->Update();
  LabelImage::Pointer labels = filter->GetOutput();
  labels->DisconnectPipeline();
  return labels;
}

/** The layers of a file with several values at each voxel; empty where it has one. */
std::vector<LabelImage::Pointer>
ReadLayers(const std::string & path)
{
  using Layers = itk::VectorImage<float, 3>;
  const Layers::Pointer            image = ReadComponents(path);
  std::vector<LabelImage::Pointer> layers;
  for (unsigned int k = 0; image && k < image->GetNumberOfComponentsPerPixel(); ++k)
  {
    auto select = itk::VectorIndexSelectionCastImageFilter<Layers, CTImage>::New();
    select->SetInput(image);
    select->SetIndex(k);
    select->Update();
    layers.push_back(ToLabels(select->GetOutput(), path));
  }
  return layers;
}
LabelFile
ReadFile(const std::string & path, Reading reading)
{
  LabelFile file;
  file.names = ReadLabelNames(path);
  file.layers = HasExtension(path, ".seg.nrrd") ? ReadLayers(path) : file.layers;
  if (file.layers.empty())
  {
    std::vector<std::string> notes;
    const auto               source = OpenVolume(path, "", notes, reading);
    RequireSensibleGrid(source->GetOutput(), path);
    const auto filter = LabelFilter::New();
    filter->SetPath(path);
    filter->SetSource(source);
    filter->UpdateOutputInformation();
    file.source = filter;
    file.layers = { filter->GetOutput() };
    for (LabelName & name : file.names)
    {
      name.layer = 0;
    }
  }
  for (const LabelName & name : file.names)
  {
    if (name.layer >= file.layers.size())
    {
      throw IOError(path, "names the segment '" + name.name + "' in a layer that it does not have");
    }
  }
  return file;
}
} // namespace

LabelFile
ReadLabelFile(const std::string & path)
{
  LabelFile file = ReadFile(path, Reading::Whole);
  if (file.source)
  {
    file.layers.front()->Update();
    file.layers.front()->DisconnectPipeline();
    file.source = nullptr;
  }
  return file;
}

LabelFile
OpenLabelFile(const std::string & path)
{
  LabelFile file = ReadFile(path, Reading::ByRegion);
  if (file.source)
  {
    file.layers.front()->ReleaseDataFlagOn();
  }
  return file;
}

LabelImage::Pointer
ReadLabels(const std::string & path)
{
  const LabelFile file = ReadLabelFile(path);
  if (file.layers.size() > 1)
  {
    throw IOError(
      path,
      Say("has ",
          file.layers.size(),
          " layers of overlapping segments where a label map of one is needed: export one segment as a label map"));
  }
  return file.layers.front();
}
} // namespace bone
