/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageFile.h"
#include "boneLabelIO.h"
#include "boneLabelValue.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <itkImageRegionConstIteratorWithIndex.h>
#include <itkVectorImage.h>
#include <itkVectorIndexSelectionCastImageFilter.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
LabelImage::Pointer
ToLabels(const CTImage * values, const std::string & path)
{
  using Limits = std::numeric_limits<LabelImage::PixelType>;
  RequireFinite(values, path);
  RequireSensibleGrid(values, path);
  auto labels = LabelImage::New();
  labels->CopyInformation(values);
  labels->SetRegions(values->GetBufferedRegion());
  labels->Allocate();
  LabelImage::PixelType *                         label = labels->GetBufferPointer();
  itk::ImageRegionConstIteratorWithIndex<CTImage> it(values, values->GetBufferedRegion());
  for (; !it.IsAtEnd(); ++it, ++label)
  {
    const float value = it.Get();
    if (!(value >= Limits::lowest() && value <= Limits::max()) || value != std::floor(value))
    {
      throw IOError(path,
                    Say("is no label map: its value at ",
                        it.GetIndex(),
                        " is ",
                        value,
                        ", no whole number from ",
                        Limits::lowest(),
                        " to ",
                        Limits::max()));
    }
    *label = static_cast<LabelImage::PixelType>(value);
  }
  if (StatesOneBone(*values))
  {
    StateOneBone(*labels);
  }
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
} // namespace

LabelFile
ReadLabelFile(const std::string & path)
{
  LabelFile file;
  file.names = ReadLabelNames(path);
  file.layers = HasExtension(path, ".seg.nrrd") ? ReadLayers(path) : file.layers;
  if (file.layers.empty())
  {
    std::vector<std::string> notes;
    file.layers = { ToLabels(ReadVolume(path, "", notes), path) };
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
