/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// An atlas of shape and density, with pictures of its first modes at +-3 standard deviations (the paper's Figure 14):
//   boneAtlasExample FOLDER                    of eight phantom hemipelves
//   boneAtlasExample FOLDER SURFACE SURFACE... of closed surfaces of one bone, x along it, with simulated densities
//   boneAtlasExample FOLDER ATLAS.h5           pictures of an atlas there is
// FOLDER gets atlas.h5, shape_modes.png and radiograph_modes.png.

#include "boneBuildPipeline.h"
#include "boneModelPictures.h"
#include "bonePopulation.h"

#include "boneMakePhantom.h"
#include "boneModelIO.h"
#include "bonePhantomImageSource.h"
#include "boneStatisticalModelEstimator.h"
#include "boneSurfacePhantom.h"

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>

namespace
{
using bone::CTImage;
using bone::LabelImage;
using MeshType = bone::DensityMesh<double>;

/** One subject: its layered mesh or, where there is none, its surface; and its simulated CT. */
struct Subject
{
  std::string           name;
  bone::MeshArrays      mesh;
  bone::TriangleSurface surface;
  CTImage::Pointer      ct;
};

using Source = bone::PhantomImageSource<CTImage>;

Source::Pointer
Scan(const bone::PhantomModel::Pointer & phantom)
{
  auto                source = Source::New();
  Source::SpacingType spacing;
  spacing.Fill(1.0);
  source->SetModel(phantom);
  source->SetSpacing(spacing);
  source->Update();
  return source;
}

/** The toolkit's own chain, as far as the mesh. `axis`: that the slices are stacked along. */
MeshType::Pointer
Model(Source * source, unsigned int axis)
{
  LabelImage::Pointer labels = source->GetLabelOutput();
  bone::BuildPipeline pipeline(/* levels */ 1);
  pipeline.SetImage(source->GetOutput());
  pipeline.SetLabelImage(labels);
  pipeline.GetSnake()->SetAxis(axis);
  pipeline.GetSnake()->SetSliceStep(4.0);
  pipeline.SetContourSpacing(8.0);
  pipeline.GetQuality()->Update();
  MeshType::Pointer mesh = pipeline.GetQuality()->GetOutput();
  mesh->DisconnectPipeline();
  return mesh;
}

void
DrawModes(const bone::StatisticalModel & model,
          const std::string &            folder,
          const bone::Vector3 &          look,
          const bone::Vector3 &          up,
          bool                           letters = true)
{
  bone::DrawShapeModes(model, 2, look, up, letters).Write(folder + "/shape_modes.png");
  if (model.HasDensity())
  {
    bone::DrawRadiographModes(model, look, up, letters).Write(folder + "/radiograph_modes.png");
  }
}

void
Train(bone::PopulationRegistration &                population,
      const std::vector<std::function<Subject()>> & subjects,
      const std::string &                           folder,
      const bone::Vector3 &                         look,
      const bone::Vector3 &                         up,
      bool                                          letters = true)
{
  auto set = bone::MeshTrainingSet<>::New();
  for (const auto & make : subjects)
  {
    const Subject subject = make();
    auto          mesh = MeshType::New();
    mesh->SetArrays(subject.mesh.tetrahedra.empty() ? population.Bring(subject.surface, subject.ct)
                                                    : population.Bring(subject.mesh, subject.ct));
    set->AddSubject(subject.name, mesh);
    const auto & report = population.GetFilter()->GetReport();
    std::cout << subject.name << ": " << report.surfaceDistance << " mm from the subject" << std::endl;
  }
  auto estimator = bone::StatisticalModelEstimator<>::New();
  estimator->SetInput(set);
  estimator->Update();
  const auto * model = estimator->GetOutput();
  bone::WriteStatisticalModel(model, folder + "/atlas.h5");
  DrawModes(*model, folder, look, up, letters);
  std::cout << model->GetContent().shape.GetNumberOfModes() << " modes of shape, "
            << model->GetContent().density.GetNumberOfModes() << " of density\n";
}

void
TrainHemipelves(const std::string & folder)
{
  bone::PopulationRegistration          population(Model(Scan(bone::MakePhantom("hemipelvis", 0)), 2), /* degree */ 2);
  std::vector<std::function<Subject()>> subjects;
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
  {
    subjects.push_back([seed] {
      const auto source = Scan(bone::MakePhantom("hemipelvis", seed));
      return Subject{ "hemipelvis " + std::to_string(seed), Model(source, 2)->GetArrays(), {}, source->GetOutput() };
    });
  }
  Train(population, subjects, folder, -bone::Vector3::UnitX(), bone::Vector3::UnitZ());
}

Source::Pointer
ScanSurface(const bone::TriangleSurface & surface)
{
  const std::vector<bone::TriangleDistance::Triangle> triangles(surface.triangles.begin(), surface.triangles.end());
  return Scan(std::make_shared<const bone::SurfacePhantom>(surface.points, triangles));
}

void
TrainSurfaces(const std::string & folder, const std::vector<std::string> & files)
{
  bone::PopulationRegistration          population(Model(ScanSurface(bone::ReadTriangleSurface(files.front())), 0),
                                          /* degree */ 2);
  std::vector<std::function<Subject()>> subjects;
  for (const std::string & file : files)
  {
    subjects.push_back([file] {
      const auto surface = bone::ReadTriangleSurface(file);
      return Subject{ std::filesystem::path(file).stem().string(), {}, surface, ScanSurface(surface)->GetOutput() };
    });
  }
  // x runs along the bone, not to the patient's left.
  Train(population, subjects, folder, bone::Vector3::UnitY(), bone::Vector3::UnitX(), /* letters */ false);
}
} // namespace

int
main(int argc, char ** argv)
{
  if (argc < 2)
  {
    std::cerr << "usage: boneAtlasExample FOLDER [ATLAS.h5 | SURFACE SURFACE ...]\n";
    return EXIT_FAILURE;
  }
  try
  {
    std::filesystem::create_directories(argv[1]);
    if (argc == 2)
    {
      TrainHemipelves(argv[1]);
    }
    else if (argc == 3)
    {
      const auto model = bone::ReadStatisticalModel(argv[2]);
      DrawModes(*model, argv[1], -bone::Vector3::UnitX(), bone::Vector3::UnitZ());
    }
    else
    {
      TrainSurfaces(argv[1], std::vector<std::string>(argv + 2, argv + argc));
    }
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
