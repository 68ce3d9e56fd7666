/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageIO.h"
#include "boneMeshIO.h"
#include "boneTestMeshes.h"

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>

namespace bone
{
namespace
{
class Folder
{
public:
  Folder()
  {
    std::string name = (std::filesystem::temp_directory_path() / "bone-io-benchmark-XXXXXX").string();
    m_Path = mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(m_Path); }
  Folder(const Folder &) = delete;
  Folder &
  operator=(const Folder &) = delete;
  std::string
  operator/(const char * name) const
  {
    return (m_Path / name).string();
  }

private:
  std::filesystem::path m_Path;
};

// Copies of the two-cube box side by side: 33,000 tetrahedra of the given degree.
MeshArrays
ManyBoxes(int degree)
{
  const auto box = DensityBox({ degree });
  MeshArrays mesh = box;
  for (int copy = 1; copy < 33000 / 12; ++copy)
  {
    const auto offset = static_cast<IdType>(mesh.points.size());
    for (const Vector3 & p : box.points)
    {
      mesh.points.emplace_back(p + 5.0 * copy * Vector3::UnitX());
    }
    for (Id4 tetra : box.tetrahedra)
    {
      for (IdType & v : tetra)
      {
        v += offset;
      }
      mesh.tetrahedra.push_back(tetra);
    }
    const auto append = [](auto & to, const auto & from) { to.insert(to.end(), from.begin(), from.end()); };
    append(mesh.layer, box.layer);
    append(mesh.slice, box.slice);
    append(mesh.region, box.region);
    append(mesh.degree, box.degree);
    append(mesh.coefficients, box.coefficients);
  }
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

void
WriteMesh(benchmark::State & state)
{
  const Folder folder;
  const auto   mesh = ManyBoxes(static_cast<int>(state.range(0)));
  for (auto _ : state)
  {
    WriteMeshArrays(mesh, folder / "m.vtu");
  }
  state.counters["MB"] = static_cast<double>(std::filesystem::file_size(folder / "m.vtu")) / 1e6;
}
BENCHMARK(WriteMesh)->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond);

void
ReadMesh(benchmark::State & state)
{
  const Folder folder;
  WriteMeshArrays(ManyBoxes(static_cast<int>(state.range(0))), folder / "m.vtu");
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(ReadMeshArrays(folder / "m.vtu"));
  }
}
BENCHMARK(ReadMesh)->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond);

CTImage::Pointer
Ramp()
{
  auto image = CTImage::New();
  image->SetRegions(CTImage::SizeType{ { 256, 256, 128 } });
  image->Allocate();
  for (int i = 0; i < 256 * 256 * 128; ++i)
  {
    image->GetBufferPointer()[i] = static_cast<float>(i % 1500);
  }
  return image;
}

void
WriteVolume(benchmark::State & state, const char * name)
{
  const Folder folder;
  const auto   image = Ramp();
  for (auto _ : state)
  {
    WriteImage(image, folder / name);
  }
}
BENCHMARK_CAPTURE(WriteVolume, mha, "v.mha")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(WriteVolume, nii_gz, "v.nii.gz")->Unit(benchmark::kMillisecond);

void
ReadVolume(benchmark::State & state, const char * name)
{
  const Folder folder;
  WriteImage(Ramp(), folder / name);
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(ReadCT(folder / name));
  }
}
BENCHMARK_CAPTURE(ReadVolume, mha, "v.mha")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ReadVolume, nii_gz, "v.nii.gz")->Unit(benchmark::kMillisecond);
} // namespace
} // namespace bone
