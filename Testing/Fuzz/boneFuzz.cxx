/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
/** Damages files of every format that BoneTK reads, reads them, and works with what is read. What may come of it: it is
 * read, or refused by an exception of one line. What may not: a signal, more than ten seconds, more than 4 GB, or
 * voxels other than those written where their checksum does not agree. */
#include "boneFuzzSeeds.h"
#include "boneMutator.h"

#include "boneBuildParameters.h"
#include "boneContourIO.h"
#include "boneContourTilingMeshSource.h"
#include "boneCorrespondenceIO.h"
#include "boneDRRImageFilter.h"
#include "boneDensityImageFilter.h"
#include "boneFileName.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneLabelChoice.h"
#include "boneMeshIO.h"
#include "boneMeshValidator.h"
#include "boneModelIO.h"
#include "bonePopulation.h"
#include "boneSurfaceLabels.h"
#include "boneTetraCollapseFilter.h"
#include "boneTetraSmoothingFilter.h"

#include <CLI/CLI.hpp>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
extern "C" const char *
__asan_default_options()
{
  return "hard_rss_limit_mb=4096:max_allocation_size_mb=4096:allocator_may_return_null=1:detect_leaks=0";
}
#endif

namespace
{
namespace fs = std::filesystem;
using Mesh = bone::DensityMesh<double>;

constexpr unsigned int   LongestSeconds = 10;
constexpr std::streamoff HalfOfSmallFile = 400; // headers of compressed images end before

std::string
ReadBytes(const std::string & path)
{
  std::ifstream stream(path, std::ios::binary);
  return { std::istreambuf_iterator<char>(stream), {} };
}

void
WriteBytes(const std::string & path, const std::string & bytes)
{
  std::ofstream(path, std::ios::binary) << bytes;
}

bone::XRayGeometry::Pointer
SmallView(const bone::MeshArrays & mesh)
{
  bone::XRayGeometry::View view;
  view.source = mesh.points.front() - 500.0 * bone::Vector3::UnitY();
  view.detectorOrigin = mesh.points.front() + bone::Vector3(-20.0, 100.0, -20.0);
  view.size = { { 12, 12 } };
  view.spacing = { 4.0, 4.0 };
  auto geometry = bone::XRayGeometry::New();
  geometry->SetView(view);
  return geometry;
}

/** What commands do with a mesh. */
void
UseMesh(const std::string & path)
{
  ValidateMesh(bone::ReadMeshArrays(path));
  const Mesh::Pointer mesh = bone::ReadDensityMesh(path);
  auto                smoothing = bone::TetraSmoothingFilter<Mesh>::New();
  smoothing->SetInput(mesh);
  smoothing->SetIterations(1);
  smoothing->Update();
  auto collapse = bone::TetraCollapseFilter<Mesh>::New();
  collapse->SetInput(mesh);
  collapse->SetLevels({ std::max<bone::IdType>(1, mesh->GetNumberOfTetrahedra() / 2) });
  collapse->Update();
  auto radiograph = bone::DRRImageFilter<Mesh, bone::CTImage>::New();
  radiograph->SetInput(mesh);
  radiograph->SetGeometry(SmallView(mesh->GetArrays()));
  radiograph->Update();
}

void
UseContours(const std::string & path)
{
  auto tiling = bone::ContourTilingMeshSource<Mesh>::New();
  tiling->SetInput(bone::ReadContours(path));
  tiling->Update();
}

void
UseSurface(const std::string & path)
{
  auto grid = bone::LabelImage::New();
  grid->SetRegions(bone::LabelImage::SizeType{ { 20, 20, 20 } });
  grid->SetSpacing(itk::Vector<double, 3>(2.0));
  bone::LabelsOfSurface(bone::ReadTriangleSurface(path), grid);
}

void
UseGeometry(const std::string & path)
{
  for (const auto & view : bone::ReadGeometry(path))
  {
    const auto & size = view->GetView().size;
    if (static_cast<double>(size[0]) * size[1] <= 1e5)
    {
      const Mesh::Pointer mesh = bone::ReadDensityMesh((fs::path(path).parent_path() / "model_L2.vtu").string());
      auto                radiograph = bone::DRRImageFilter<Mesh, bone::CTImage>::New();
      radiograph->SetInput(mesh);
      radiograph->SetGeometry(view);
      radiograph->Update();
    }
  }
}

void
UseAtlas(const std::string & path)
{
  const auto   model = bone::ReadStatisticalModel(path);
  const auto & content = model->GetContent();
  model->Synthesize(Eigen::VectorXd::Ones(content.shape.GetNumberOfModes()),
                    Eigen::VectorXd::Ones(content.density.GetNumberOfModes()));
}

void
UseLabels(const std::string & path)
{
  const bone::LabelFile file = bone::ReadLabelFile(path);
  const auto            labels = bone::CountLabels(file);
  if (!labels.empty())
  {
    bone::ChooseBones(file, { labels[0].name.empty() ? std::to_string(labels[0].value) : labels[0].name });
  }
}

void
UseParameters(const std::string & path)
{
  bone::BuildParameters parameters;
  bone::BuildFiles      files;
  bone::ReadBuildParameters(path, parameters, files);
}

/** A format: the file that is damaged, and what reads it, given the path of that file. */
struct Format
{
  std::string                              file;
  std::function<void(const std::string &)> use;
  bool                                     gzip{ false };
  bool                                     checked{ false }; ///< an image whose voxels have a checksum
};

std::vector<Format>
Formats()
{
  const auto ct = [](const std::string & path) { bone::ReadCT(path); };
  const auto folder = [](const std::string & path) { bone::ReadCT(fs::path(path).parent_path().string()); };
  const auto beside = [](const char * name, auto && use) {
    return [name, use](const std::string & path) { use((fs::path(path).parent_path() / name).string()); };
  };
  return { { "ct.nii", ct },
           { "ct.nii.gz", ct, true, true },
           { "labels.nii.gz", UseLabels, true, true },
           { "ct.mha", ct },
           { "labels.mha", UseLabels, false, true },
           { "ct.mhd", ct },
           { "ct.nrrd", ct },
           { "labels.nrrd", UseLabels, false, true },
           { "segments.seg.nrrd", UseLabels },
           { "dicom/2.dcm", folder },
           { "dicom/1.dcm", [](const std::string & path) { bone::ReadRadiograph(path); } },
           { "contours.vtp", UseContours },
           { "contours.mrk.json", UseContours },
           { "surface.vtp", UseSurface },
           { "surface.stl", UseSurface },
           { "surface.ply", UseSurface },
           { "surface_binary.stl", UseSurface },
           { "surface_binary.ply", UseSurface },
           { "model_L1.vtu", UseMesh },
           { "model.hierarchy.json", [](const std::string & path) { bone::ReadHierarchy(path); } },
           { "model_L2.vtu", beside("model.hierarchy.json", [](const std::string & p) { bone::ReadHierarchy(p); }) },
           { "view.json", UseGeometry },
           { "matrix.json", UseGeometry },
           { "plastimatch.json", UseGeometry },
           { "geometry.xml", beside("rtk.json", UseGeometry) },
           { "rtk.json", UseGeometry },
           { "atlas.h5", UseAtlas },
           { "correspondence.json", [](const std::string & path) { bone::ReadCorrespondence(path); } },
           { "names.csv", [](const std::string & path) { bone::ReadLabelTable(path); } },
           { "names.json", [](const std::string & path) { bone::ReadLabelTable(path); } },
           { "subjects.txt", [](const std::string & path) { bone::VerifySubjects(bone::ReadSubjectList(path)); } },
           { "report.json", UseParameters } };
}

/** What came of one input, told by the child through its exit code or by what ended it. */
enum Outcome
{
  Read = 0,
  Refused = 1,
  BadMessage = 2,
  Silent = 3
};

/** Whether the voxels are those of the whole file. */
bool
SameVoxels(const std::string & path, const std::string & whole)
{
  const auto a = bone::ReadCT(path);
  const auto b = bone::ReadCT(whole);
  const auto region = a->GetBufferedRegion();
  return region == b->GetBufferedRegion() &&
         std::equal(a->GetBufferPointer(), a->GetBufferPointer() + region.GetNumberOfPixels(), b->GetBufferPointer());
}

/** Reads one damaged file. `payload`: only bytes that have a checksum are damaged. */
Outcome
Try(const Format & format, const std::string & path, const std::string & whole, bool payload)
{
  try
  {
    format.use(path);
    return payload && !SameVoxels(path, whole) ? Silent : Read;
  }
  catch (const itk::ExceptionObject & error)
  {
    const std::string line = bone::ErrorLine(error);
    std::cerr << "refused: " << line << std::endl;
    return line.empty() || line.find('\n') != std::string::npos || line.find("0x") != std::string::npos ? BadMessage
                                                                                                        : Refused;
  }
  catch (const std::bad_alloc &)
  {
    return Refused;
  }
  catch (const std::exception & error)
  {
    const std::string line = error.what();
    std::cerr << "refused: " << line << std::endl;
    return line.empty() || line.find('\n') != std::string::npos || line.find("json.exception") != std::string::npos
             ? BadMessage
             : Refused;
  }
}

/** Damage that a checksum must find: behind the header, and not the file's end alone. */
std::string
DamagePayload(const std::string & bytes, bone::Mutator & mutator)
{
  std::string       damaged = bytes;
  const std::size_t first = std::min<std::size_t>(HalfOfSmallFile, bytes.size() / 2);
  const std::size_t at = first + mutator.Below(bytes.size() - first);
  damaged[at] = static_cast<char>(damaged[at] ^ (1 << mutator.Below(8)));
  return damaged;
}

class Fuzzer
{
public:
  Fuzzer(std::string seeds, std::string folder)
    : m_Seeds(std::move(seeds))
    , m_Folder(std::move(folder))
  {
    fs::create_directories(m_Folder + "/keep");
    fs::copy(m_Seeds, m_Folder, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }

  /** Returns how many inputs came out as they must not; these are kept. */
  std::size_t
  Run(const Format & format, std::size_t count, std::uint64_t seed)
  {
    const std::string whole = m_Seeds + "/" + format.file;
    const std::string bytes = ReadBytes(whole);
    const std::string path = m_Folder + "/" + format.file;
    std::size_t       counts[4] = {};
    std::size_t       bad = 0;
    if (const std::string what = this->Child([&] { return Try(format, path, whole, format.checked); }, counts);
        !what.empty() || counts[Read] != 1)
    {
      std::cout << format.file << " is not read as it is, see " << m_Folder << "/child.log" << std::endl;
      return 1;
    }
    for (std::size_t i = 0; i < count; ++i)
    {
      bone::Mutator mutator(seed * 1000003 + i);
      const bool    payload = format.checked && i % 4 == 0;
      const bool    within = format.gzip && i % 2 == 1;
      WriteBytes(path,
                 payload  ? DamagePayload(bytes, mutator)
                 : within ? mutator.DamageWithin(bytes)
                          : mutator.Damage(bytes));
      const std::string what = this->Child([&] { return Try(format, path, whole, payload); }, counts);
      if (!what.empty())
      {
        ++bad;
        const std::string kept = m_Folder + "/keep/" + std::to_string(seed) + "_" + std::to_string(i) + "_" +
                                 fs::path(format.file).filename().string();
        fs::copy_file(path, kept, fs::copy_options::overwrite_existing);
        fs::copy_file(m_Folder + "/child.log", kept + ".log", fs::copy_options::overwrite_existing);
        std::cout << format.file << " " << i << ": " << what << ", kept as " << kept << std::endl;
      }
    }
    WriteBytes(path, bytes);
    std::cout << format.file << ": " << count << " inputs, " << counts[Read] << " read, " << counts[Refused]
              << " refused, " << bad << " bad" << std::endl;
    return bad;
  }

private:
  /** Runs `action` in a process of its own. Returns what is wrong with its end, empty where nothing is. */
  template <typename TAction>
  std::string
  Child(TAction && action, std::size_t (&counts)[4])
  {
    const pid_t child = fork();
    if (child == 0)
    {
      const int log = open((m_Folder + "/child.log").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      dup2(log, STDOUT_FILENO);
      dup2(log, STDERR_FILENO);
      alarm(LongestSeconds);
      _exit(action());
    }
    int    status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    if (WIFSIGNALED(status))
    {
      return WTERMSIG(status) == SIGALRM ? "takes too long" : "signal " + std::to_string(WTERMSIG(status));
    }
    if (usage.ru_maxrss > 4L << 20)
    {
      return "needs " + std::to_string(usage.ru_maxrss >> 20) + " GB";
    }
    const int code = WEXITSTATUS(status);
    if (code <= Silent)
    {
      ++counts[code];
    }
    return code == Read || code == Refused ? ""
           : code == BadMessage            ? "its message is not one line for a person"
           : code == Silent                ? "damaged voxels were read"
                                           : "the sanitizer, or exit code " + std::to_string(code);
  }

  std::string m_Seeds;
  std::string m_Folder;
};
} // namespace

int
main(int argc, char ** argv)
{
  CLI::App      app("Damages files of every format, reads them, and says what must not come of it");
  std::string   folder;
  std::string   only;
  std::size_t   count = 20;
  std::uint64_t seed = 1;
  app.add_option("folder", folder, "Where seeds and damaged files are made; what is bad is kept in its keep/")
    ->required();
  app.add_option("--count", count, "Damaged files of each format");
  app.add_option("--seed", seed, "Of the damage");
  app.add_option("--format", only, "Only the format of this file, such as ct.nii.gz");
  CLI11_PARSE(app, argc, argv);

  itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(1); // threads do not live through fork()
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  fs::create_directories(folder + "/seeds");
  bone::WriteFuzzSeeds(folder + "/seeds");
  Fuzzer      fuzzer(folder + "/seeds", folder + "/work");
  std::size_t bad = 0;
  for (const Format & format : Formats())
  {
    if (only.empty() || only == format.file)
    {
      bad += fuzzer.Run(format, count, seed);
    }
  }
  std::cout << bad << " bad" << std::endl;
  return bad == 0 ? 0 : 1;
}
