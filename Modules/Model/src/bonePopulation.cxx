/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePopulation.h"

#include "boneDensityFitFilter.h"
#include "boneDensityFitKernel.h"
#include "boneFileName.h"
#include "boneIOError.h"
#include "boneTetraLocator.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

/** Of a name in a message; a file that is no list has lines of any length. */
constexpr std::size_t LongestName = 200;

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

/** The last `count` parts of a path, without extension and with '_' between them. */
std::string
LastParts(const fs::path & path, int count)
{
  std::string name = path.stem().string();
  fs::path    folder = fs::absolute(path).lexically_normal().parent_path();
  for (; count > 1 && folder.has_filename(); --count, folder = folder.parent_path())
  {
    name = folder.filename().string() + '_' + name;
  }
  return name;
}

/** By their files; where these do not tell them apart, as those of builds, by the folders too. */
void
NameSubjects(std::vector<SubjectFiles> & subjects)
{
  constexpr int         most = 4;
  std::set<std::string> names;
  std::set<std::string> files;
  for (int parts = 1; parts <= most && names.size() < subjects.size(); ++parts)
  {
    names.clear();
    for (SubjectFiles & subject : subjects)
    {
      subject.name = LastParts(subject.shape, parts);
      names.insert(subject.name);
      files.insert(LastParts(subject.shape, 1));
    }
  }
  const std::string tail = '_' + *files.begin();
  for (SubjectFiles & subject : subjects)
  {
    if (files.size() == 1 && subject.name.size() > tail.size())
    {
      subject.name.resize(subject.name.size() - tail.size()); // the same for all
    }
  }
}
} // namespace

void
VerifySubjects(const std::vector<SubjectFiles> & subjects)
{
  for (const SubjectFiles & subject : subjects)
  {
    if (IsMesh(subject.shape))
    {
      ReadMeshArrays(subject.shape);
    }
    else
    {
      ReadTriangleSurface(subject.shape);
    }
    if (!subject.ct.empty())
    {
      ReadCT(subject.ct);
    }
  }
}

std::vector<SubjectFiles>
ReadSubjectList(const std::string & path, std::size_t least)
{
  RequireReadableFile(path);
  std::ifstream             stream(path);
  std::vector<SubjectFiles> subjects;
  std::size_t               number = 0;
  const auto                require = [&](const std::string & file) {
    std::error_code error;
    if (!fs::exists(file, error))
    {
      throw IOError(path, "line " + std::to_string(number) + ": there is no file " + file.substr(0, LongestName));
    }
  };
  for (std::string line; std::getline(stream, line);)
  {
    ++number;
    line = Trim(line);
    if (std::any_of(line.begin(), line.end(), [](unsigned char c) { return c < ' ' && c != '\t'; }))
    {
      throw IOError(path, "line " + std::to_string(number) + " is no text");
    }
    if (line.empty() || line[0] == '#')
    {
      continue;
    }
    const auto   comma = line.find(',');
    SubjectFiles subject;
    subject.shape = Beside(fs::path(path).parent_path(), Trim(line.substr(0, comma)));
    subject.ct =
      comma == std::string::npos ? std::string() : Beside(fs::path(path).parent_path(), Trim(line.substr(comma + 1)));
    require(subject.shape);
    if (!subject.ct.empty())
    {
      require(subject.ct);
    }
    subjects.push_back(subject);
  }
  if (subjects.size() < least)
  {
    throw IOError(
      path, std::string("the list must have ") + (least == 1 ? "a subject" : "two subjects") + " or more, one a line");
  }
  NameSubjects(subjects);
  return subjects;
}

namespace
{
/** A model's density, looked up in the cells of one region, or in all. */
class DensityLookup
{
public:
  /** `region`: below 0, or of no cell: all regions. */
  DensityLookup(const MeshArrays & model, int region)
    : m_Model(model)
    , m_Cells(CellsOf(model, region))
    , m_Locator(Part(model, m_Cells))
  {}

  /** At x, or at the nearest place in the cells. `hint`: where the last one was found. */
  double
  Value(const Vector3 & x, IdType & hint) const
  {
    const CellLocation place = m_Locator.FindNearest(x, hint);
    hint = place.cell;
    const auto cell = static_cast<std::size_t>(m_Cells[static_cast<std::size_t>(place.cell)]);
    const auto stride = static_cast<std::size_t>(BernsteinCount(m_Model.maximumDegree));
    return BernsteinValue(m_Model.degree[cell], &m_Model.coefficients[cell * stride], place.mu);
  }

private:
  static std::vector<IdType>
  CellsOf(const MeshArrays & model, int region)
  {
    std::vector<IdType> cells;
    const bool          any = std::count(model.region.begin(), model.region.end(), region) == 0;
    for (std::size_t t = 0; t < model.tetrahedra.size(); ++t)
    {
      if (any || model.region[t] == region)
      {
        cells.push_back(static_cast<IdType>(t));
      }
    }
    return cells;
  }

  static MeshArrays
  Part(const MeshArrays & model, const std::vector<IdType> & cells)
  {
    MeshArrays part;
    part.points = model.points;
    for (const IdType t : cells)
    {
      part.tetrahedra.push_back(model.tetrahedra[static_cast<std::size_t>(t)]);
    }
    part.neighbors = ComputeFaceNeighbors(part.tetrahedra);
    return part;
  }

  const MeshArrays &  m_Model;
  std::vector<IdType> m_Cells;
  TetraLocator        m_Locator;
};
} // namespace

void
FitDensityOfModel(const MeshArrays & model, int degree, MeshArrays & mesh)
{
  if (!model.HasDensity())
  {
    itkGenericExceptionMacro("The subject's mesh has no density to be taken over.");
  }
  const DensityFitKernel kernel(degree, DensityFitKernel::MinimumLattice(degree));
  const auto             count = static_cast<std::size_t>(BernsteinCount(degree));
  mesh.maximumDegree = degree;
  mesh.quantity = model.quantity;
  mesh.degree.assign(mesh.tetrahedra.size(), degree);
  mesh.coefficients.assign(mesh.tetrahedra.size() * count, 0.0);
  std::map<int, DensityLookup> lookups;
  std::map<int, IdType>        hints;
  std::vector<double>          values(kernel.SamplePoints().size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const int    region = mesh.region.empty() ? -1 : mesh.region[t];
    const auto & lookup = lookups.try_emplace(region, model, region).first->second;
    IdType &     hint = hints.try_emplace(region, -1).first->second;
    const Id4 &  c = mesh.tetrahedra[t];
    for (std::size_t s = 0; s < values.size(); ++s)
    {
      const Barycentric & mu = kernel.SamplePoints()[s];
      values[s] = lookup.Value(mu[0] * mesh.points[c[0]] + mu[1] * mesh.points[c[1]] + mu[2] * mesh.points[c[2]] +
                                 mu[3] * mesh.points[c[3]],
                               hint);
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

MeshArrays
FitDensityOfImage(const CTImage * ct, int degree, const MeshArrays & mesh)
{
  auto placed = DensityMesh<double>::New();
  placed->SetArrays(mesh);
  auto fit = DensityFitFilter<CTImage>::New();
  fit->SetImage(ct);
  fit->SetMesh(placed);
  fit->SetDegree(degree);
  fit->SetInterpolator(DensityInterpolator::CubicBSpline);
  fit->Update();
  return fit->GetOutput()->GetArrays();
}

MeshArrays
PopulationRegistration::Bring(const TriangleSurface & surface, const CTImage * ct)
{
  m_Register->SetSubjectSurface(surface);
  return this->Register(nullptr, ct);
}

MeshArrays
PopulationRegistration::Bring(MeshArrays own, const CTImage * ct)
{
  if (own.tetrahedra == m_Standard->GetTetrahedra() && own.points.size() == m_Standard->GetNumberOfPoints())
  {
    m_Registered = false;
    return ct != nullptr ? FitDensityOfImage(ct, m_Degree, own) : own;
  }
  if (own.neighbors.empty())
  {
    own.neighbors = ComputeFaceNeighbors(own.tetrahedra);
  }
  auto subject = DensityMesh<double>::New();
  subject->SetArrays(own);
  m_Register->SetSubject(subject);
  return this->Register(&own, ct);
}

MeshArrays
PopulationRegistration::Register(const MeshArrays * own, const CTImage * ct)
{
  m_Register->Update();
  m_Registered = true;
  MeshArrays                 mesh = m_Register->GetOutput()->GetArrays();
  const std::vector<Vector3> points = mesh.points;
  if (m_Register->GetReport().mirrored)
  {
    mesh.points = ReflectPoints(points); // the density is where the subject is
  }
  if (ct != nullptr)
  {
    mesh = FitDensityOfImage(ct, m_Degree, mesh);
  }
  else if (own != nullptr && own->HasDensity())
  {
    FitDensityOfModel(*own, m_Degree, mesh);
  }
  mesh.points = points;
  return mesh;
}

MeshArrays
PopulationRegistration::Bring(const SubjectFiles & subject)
{
  const CTImage::Pointer ct = subject.ct.empty() ? nullptr : ReadCT(subject.ct);
  return IsMesh(subject.shape) ? this->Bring(ReadMeshArrays(subject.shape), ct)
                               : this->Bring(ReadTriangleSurface(subject.shape), ct);
}
} // namespace bone
