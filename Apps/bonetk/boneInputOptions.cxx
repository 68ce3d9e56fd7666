/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneInputOptions.h"

#include "boneContourIO.h"
#include "boneFileName.h"
#include "boneMeshIO.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneSurfaceLabels.h"

#include <algorithm>
#include <map>

namespace bone
{
void
AddSeriesOption(CLI::App * command, std::string & series)
{
  command->add_option(
    "--series", series, "Number, UID or description of the DICOM series to read, where the CT's folder has several");
}

namespace
{
/** What `read` makes of a CT, with the notes on it told. */
template <typename TRead>
auto
ReadChosen(const TRead & read, const std::string & path, const std::string & series, Session & session)
{
  try
  {
    std::vector<std::string> notes;
    auto                     ct = read(path, series, &notes);
    for (const std::string & note : notes)
    {
      session.Warn(path + ": " + note);
    }
    return ct;
  }
  catch (const SeveralSeries & error)
  {
    throw UsageError(ErrorLine(error) + ". Choose one with --series");
  }
}
} // namespace

CTImage::Pointer
ReadChosenCT(const std::string & path, const std::string & series, Session & session)
{
  return ReadChosen(ReadCT, path, series, session);
}

VolumeSource::Pointer
OpenChosenCT(const std::string & path, const std::string & series, Session & session)
{
  return ReadChosen(OpenCT, path, series, session);
}

CLI::Option *
LabelOptions::AddTo(CLI::App * command, const std::string & help, bool several)
{
  auto * labelsOption = command->add_option("--labels", file, help);
  command
    ->add_option(
      "--label",
      wanted,
      several ? "Value or name of the bone in the label map; several, apart by commas, each after a --label, or as a "
                "pattern ('rib_*'; '*': all), are built one after another into folders of their own. Default: "
                "its only label"
              : "Value or name of the bone in the label map; default: its only label")
    ->expected(1)
    ->multi_option_policy(several ? CLI::MultiOptionPolicy::TakeAll : CLI::MultiOptionPolicy::Throw)
    ->type_name("VALUE|NAME");
  if (several)
  {
    command->get_option("--label")->allow_extra_args(false)->delimiter(',');
  }
  command
    ->add_option("--label-names",
                 names,
                 "Table of the labels' values and names (.csv, .txt, .ctbl, .json), where the label map has none")
    ->needs(labelsOption);
  return labelsOption;
}

void
BoneOptions::AddTo(CLI::App * command, bool several)
{
  labels.AddTo(command,
               "Where the bone is: a label map, resampled where its grid is not the CT's, or a closed surface (.stl, "
               ".ply, .vtp; mm, LPS)",
               several);
  auto * initOption = command->add_option("--init",
                                          init,
                                          "Initial contours: .vtp, .mrk.json of 3D Slicer, DICOM structure set (.dcm), "
                                          "or a label map of some slices; may be given with --labels");
  command->add_option("--structure", structure, "The bone's name in a DICOM structure set; default: the only structure")
    ->needs(initOption);
}

void
BoneOptions::Verify() const
{
  if (labels.file.empty() && init.empty())
  {
    throw UsageError("--labels or --init is required: they say where the bone is");
  }
  if (!init.empty() && labels.wanted.size() > 1)
  {
    throw UsageError("--init goes with one bone: give one --label");
  }
}

namespace
{
/** "010" is 10, as everywhere; names are as they are, and 0 names none. */
std::vector<std::string>
LabelWords(const std::vector<std::string> & wanted)
{
  std::vector<std::string> words;
  for (const std::string & word : wanted)
  {
    int value = 0;
    words.push_back(ParseNumber(word, value) ? std::to_string(value) : word);
  }
  words.erase(std::remove(words.begin(), words.end(), "0"), words.end());
  return words;
}

std::vector<LabelledBone>
ChooseNamed(const LabelFile & file, const LabelOptions & options)
{
  const auto wanted = LabelWords(options.wanted);
  try
  {
    return ChooseBones(file, wanted);
  }
  catch (const itk::ExceptionObject & error)
  {
    if (wanted.empty())
    {
      throw UsageError(options.file + ": " + ErrorLine(error) + ". Choose one with --label");
    }
    const std::string table = options.names.empty() ? "" : " with the names of " + options.names;
    throw IOError(options.file + table, ErrorLine(error));
  }
}

/** Throws where a pattern means several bones, and one is needed. */
template <typename TBone>
TBone
TheOnly(std::vector<TBone> bones, const LabelOptions & options)
{
  if (bones.size() > 1)
  {
    throw UsageError("--label " + options.wanted.front() + " means " + std::to_string(bones.size()) + " labels of " +
                     options.file + ", and one is needed");
  }
  return std::move(bones.front());
}

LabelFile
ReadNamedLabels(const LabelOptions & options, bool byRegion = false)
{
  LabelFile file = byRegion ? OpenLabelFile(options.file) : ReadLabelFile(options.file);
  if (options.names.empty())
  {
    return file;
  }
  file.names.clear();
  for (LabelName & name : ReadLabelTable(options.names))
  {
    for (name.layer = 0; name.layer < file.layers.size(); ++name.layer)
    {
      file.names.push_back(name);
    }
  }
  return file;
}

LabelImage::Pointer
BringToGrid(const LabelImage * labels, const itk::ImageBase<3> * ct, const std::string & path, Session & session)
{
  if (IsSameGrid(ct, labels))
  {
    return PutOnGrid(labels, ct);
  }
  LabelImage::Pointer image = ResampleToGrid(labels, ct); // what it throws is about both files
  session.Warn(path + " is not on the CT's grid: each voxel of the CT takes the label of the nearest one.");
  return image;
}

bool
IsSurfaceFile(const std::string & path)
{
  return HasExtension(path, ".stl") || HasExtension(path, ".ply") || HasExtension(path, ".vtp");
}

std::vector<LabelledBone>
VoxelsOfSurface(const LabelOptions & options, const itk::ImageBase<3> * ct)
{
  if (ct == nullptr)
  {
    throw UsageError(options.file + " is a surface, where a label map is needed");
  }
  if (!options.wanted.empty())
  {
    throw UsageError("--label goes with a label map; " + options.file + " is a surface");
  }
  const LabelImage::Pointer labels = LabelsOfSurface(ReadTriangleSurface(options.file), ct);
  if (CountLabels(labels).empty())
  {
    throw IOError(options.file, "holds no voxel of the CT: is it in mm and in LPS, the CT's coordinates?");
  }
  return { { labels, 1, "", CountLabels(labels).front().region, nullptr } };
}
} // namespace

std::vector<LabelledBone>
ReadBoneLabels(const LabelOptions & options, const itk::ImageBase<3> * ct, Session & session, bool byRegion)
{
  if (IsSurfaceFile(options.file))
  {
    return VoxelsOfSurface(options, ct);
  }
  std::vector<LabelledBone>                         bones = ChooseNamed(ReadNamedLabels(options, byRegion), options);
  std::map<const LabelImage *, LabelImage::Pointer> onGrid; // bones share a label map
  for (LabelledBone & bone : bones)
  {
    if (ct == nullptr || (byRegion && IsSameGrid(ct, bone.labels)))
    {
      continue;
    }
    LabelImage::Pointer & labels = onGrid[bone.labels];
    if (labels.IsNull())
    {
      labels = BringToGrid(bone.labels, ct, options.file, session);
    }
    bone = { labels, bone.label, bone.name, {}, nullptr };
  }
  return bones;
}

LabelledBone
ReadOneBoneLabels(const LabelOptions & options, const itk::ImageBase<3> * ct, Session & session, bool byRegion)
{
  return TheOnly(ReadBoneLabels(options, ct, session, byRegion), options);
}

LabelImage::Pointer
ReadLabelsOnGrid(const std::string & path, const itk::ImageBase<3> * ct, Session & session)
{
  return BringToGrid(ReadLabels(path), ct, path, session);
}

std::vector<BoneInput>
ReadBones(const BoneOptions & options, unsigned int axis, const CTImage * ct, Session & session, bool byRegion)
{
  options.Verify();
  std::vector<BoneInput> inputs;
  if (!options.labels.file.empty())
  {
    auto bones = ReadBoneLabels(options.labels, ct, session, byRegion);
    if (!options.init.empty())
    {
      bones = { TheOnly(bones, options.labels) };
    }
    for (LabelledBone & bone : bones)
    {
      inputs.push_back({ std::move(bone), nullptr });
    }
  }
  if (!options.init.empty())
  {
    inputs.resize(1);
    LabelledBone & bone = inputs.front().bone;
    const auto &   images = ImageExtensions();
    const bool     image = std::any_of(
      images.begin(), images.end(), [&options](const std::string & e) { return HasExtension(options.init, e); });
    if (!image && options.labels.file.empty() && !options.labels.wanted.empty())
    {
      throw UsageError("--label goes with a label map; " + options.init + " is none");
    }
    if (image && options.labels.file.empty())
    {
      const LabelOptions labels{ options.init, options.labels.wanted, "" };
      bone = TheOnly(ChooseNamed(ReadNamedLabels(labels), labels), labels);
      bone.labels = nullptr;
    }
    inputs.front().contours = ReadContours(options.init, { options.structure, bone.label, axis });
  }
  return inputs;
}

BoneInput
ReadOneBone(const BoneOptions & options, unsigned int axis, const CTImage * ct, Session & session)
{
  return TheOnly(ReadBones(options, axis, ct, session), options.labels);
}
} // namespace bone
