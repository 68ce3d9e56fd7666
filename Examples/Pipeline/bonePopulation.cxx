/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePopulation.h"

#include "boneDensityFitFilter.h"
#include "boneDensityFitKernel.h"
#include "boneIOError.h"
#include "boneTetraLocator.h"

#include <filesystem>
#include <fstream>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

std::string
Trim(const std::string & text)
{
  const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

std::string
Beside(const fs::path & folder, const std::string & name)
{
  return name.empty() ? name : (fs::path(name).is_absolute() ? fs::path(name) : folder / name).string();
}

bool
IsMesh(const std::string & path)
{
  return fs::path(path).extension() == ".vtu";
}
} // namespace

std::vector<SubjectFiles>
ReadSubjectList(const std::string & path)
{
  std::ifstream stream(path);
  if (!stream || fs::is_directory(path))
  {
    throw IOError(path, "the list of subjects cannot be read");
  }
  std::vector<SubjectFiles> subjects;
  for (std::string line; std::getline(stream, line);)
  {
    line = Trim(line);
    if (line.empty() || line[0] == '#')
    {
      continue;
    }
    const auto   comma = line.find(',');
    SubjectFiles subject;
    subject.shape = Beside(fs::path(path).parent_path(), Trim(line.substr(0, comma)));
    subject.ct =
      comma == std::string::npos ? std::string() : Beside(fs::path(path).parent_path(), Trim(line.substr(comma + 1)));
    subject.name = fs::path(subject.shape).stem().string();
    subjects.push_back(subject);
  }
  if (subjects.size() < 2)
  {
    throw IOError(path, "the list must have two subjects or more, one a line");
  }
  return subjects;
}

void
FitDensityOfModel(const MeshArrays & model, int degree, MeshArrays & mesh)
{
  if (!model.HasDensity())
  {
    itkGenericExceptionMacro("The subject's mesh has no density to be taken over.");
  }
  const DensityFitKernel kernel(degree, DensityFitKernel::MinimumLattice(degree));
  const TetraLocator     locator(model);
  const auto             stride = static_cast<std::size_t>(BernsteinCount(model.maximumDegree));
  const auto             count = static_cast<std::size_t>(BernsteinCount(degree));
  mesh.maximumDegree = degree;
  mesh.quantity = model.quantity;
  mesh.degree.assign(mesh.tetrahedra.size(), degree);
  mesh.coefficients.assign(mesh.tetrahedra.size() * count, 0.0);
  std::vector<double> values(kernel.SamplePoints().size());
  IdType              hint = -1;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const Id4 & c = mesh.tetrahedra[t];
    for (std::size_t s = 0; s < values.size(); ++s)
    {
      const Barycentric & mu = kernel.SamplePoints()[s];
      const Vector3       x =
        mu[0] * mesh.points[c[0]] + mu[1] * mesh.points[c[1]] + mu[2] * mesh.points[c[2]] + mu[3] * mesh.points[c[3]];
      const CellLocation place = locator.FindNearest(x, hint);
      hint = place.cell;
      const auto cell = static_cast<std::size_t>(place.cell);
      values[s] = BernsteinValue(model.degree[cell], &model.coefficients[cell * stride], place.mu);
    }
    kernel.Fit(values.data(), &mesh.coefficients[t * count]);
  }
}

PopulationRegistration::PopulationRegistration(DensityMesh<double>::Pointer standard, int degree)
  : m_Standard(std::move(standard))
  , m_Degree(degree)
  , m_Register(AtlasRegistrationFilter<>::New())
{
  m_Register->SetStandard(m_Standard);
}

void
PopulationRegistration::FitImage(const CTImage * ct, MeshArrays & mesh) const
{
  // The image is where the subject is: a reflected mesh goes back for the fit.
  const bool                   mirrored = m_Registered && m_Register->GetReport().mirrored;
  const std::vector<Vector3>   points = mesh.points;
  DensityMesh<double>::Pointer placed = DensityMesh<double>::New();
  mesh.points = mirrored ? ReflectPoints(points) : points;
  placed->SetArrays(mesh);
  auto fit = DensityFitFilter<CTImage>::New();
  fit->SetImage(ct);
  fit->SetMesh(placed);
  fit->SetDegree(m_Degree);
  fit->Update();
  mesh = fit->GetOutput()->GetArrays();
  mesh.points = points;
}

MeshArrays
PopulationRegistration::Bring(const TriangleSurface & surface, const CTImage * ct)
{
  m_Register->SetSubjectSurface(surface);
  m_Register->Update();
  m_Registered = true;
  MeshArrays mesh = m_Register->GetOutput()->GetArrays();
  if (ct != nullptr)
  {
    this->FitImage(ct, mesh);
  }
  return mesh;
}

MeshArrays
PopulationRegistration::Bring(const SubjectFiles & subject)
{
  const CTImage::Pointer ct = subject.ct.empty() ? nullptr : ReadCT(subject.ct);
  if (!IsMesh(subject.shape))
  {
    return this->Bring(ReadTriangleSurface(subject.shape), ct);
  }
  MeshArrays own = ReadMeshArrays(subject.shape);
  if (own.tetrahedra == m_Standard->GetTetrahedra() && own.points.size() == m_Standard->GetNumberOfPoints())
  {
    m_Registered = false;
    if (ct != nullptr)
    {
      this->FitImage(ct, own);
    }
    return own;
  }
  std::vector<IdType> id;
  if (own.neighbors.empty())
  {
    own.neighbors = ComputeFaceNeighbors(own.tetrahedra);
  }
  MeshArrays mesh = this->Bring(ExteriorSurface(own, id), ct);
  if (ct == nullptr && own.HasDensity())
  {
    MeshArrays placed = mesh;
    placed.points = m_Register->GetReport().mirrored ? ReflectPoints(mesh.points) : mesh.points;
    FitDensityOfModel(own, m_Degree, placed);
    placed.points = mesh.points;
    mesh = std::move(placed);
  }
  return mesh;
}
} // namespace bone
