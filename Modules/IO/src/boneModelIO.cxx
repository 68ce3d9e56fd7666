/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelIO.h"

#include "boneAtomicFile.h"
#include "boneBernstein.h"
#include "boneMeshIO.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <H5Cpp.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>

namespace bone
{
namespace
{
constexpr int LayoutVersion = 1;

using Sizes = std::vector<hsize_t>;

template <typename T>
const H5::PredType &
NativeType()
{
  if constexpr (std::is_same<T, double>::value)
  {
    return H5::PredType::NATIVE_DOUBLE;
  }
  else if constexpr (std::is_same<T, float>::value)
  {
    return H5::PredType::NATIVE_FLOAT;
  }
  else
  {
    static_assert(std::is_same<T, int>::value, "doubles, floats and ints are stored");
    return H5::PredType::NATIVE_INT;
  }
}

/** A dataset without the time it was made at: the same model gives the same file. */
H5::DataSet
MakeDataSet(const H5::Group & group, const std::string & name, const H5::DataType & type, const H5::DataSpace & space)
{
  const H5::DSetCreatPropList properties;
  H5Pset_obj_track_times(properties.getId(), false);
  return group.createDataSet(name, type, space, properties);
}

template <typename T>
void
Put(const H5::Group & group, const std::string & name, const T * data, const Sizes & sizes)
{
  const H5::DataSpace space(static_cast<int>(sizes.size()), sizes.data());
  MakeDataSet(group, name, NativeType<T>(), space).write(data, NativeType<T>());
}

void
Put(const H5::Group & group, const std::string & name, const Eigen::VectorXd & vector)
{
  Put(group, name, vector.data(), { static_cast<hsize_t>(vector.size()) });
}

/** Columns of the matrix become rows of the dataset. */
void
PutColumns(const H5::Group & group, const std::string & name, const Eigen::MatrixXd & matrix)
{
  Put(group, name, matrix.data(), { static_cast<hsize_t>(matrix.cols()), static_cast<hsize_t>(matrix.rows()) });
}

template <typename T>
void
PutScalar(const H5::Group & group, const std::string & name, T value)
{
  MakeDataSet(group, name, NativeType<T>(), H5::DataSpace()).write(&value, NativeType<T>());
}

void
PutText(const H5::Group & group, const std::string & name, const std::string & text)
{
  const H5::StrType type(H5::PredType::C_S1, std::max<std::size_t>(text.size(), 1));
  MakeDataSet(group, name, type, H5::DataSpace()).write(text, type);
}

void
PutTextAttribute(const H5::Group & group, const std::string & name, const std::string & text)
{
  const H5::StrType type(H5::PredType::C_S1, std::max<std::size_t>(text.size(), 1));
  group.createAttribute(name, type, H5::DataSpace()).write(type, text);
}

/** A dataset with its sizes. Throws where it has more entries than its file could hold, so that a damaged file asks for
 * no more memory than belongs to its size. */
H5::DataSet
Open(const H5::Group & group, const std::string & name, Sizes & sizes)
{
  constexpr double    mostOfByte = 1032.0; // bytes that zlib makes of one, where another program compressed the file
  const H5::DataSet   set = group.openDataSet(name);
  const H5::DataSpace space = set.getSpace();
  sizes.assign(static_cast<std::size_t>(space.getSimpleExtentNdims()), 0);
  space.getSimpleExtentDims(sizes.data());
  double entries = 1.0;
  for (const hsize_t size : sizes)
  {
    entries *= static_cast<double>(size);
  }
  const hid_t file = H5Iget_file_id(set.getId());
  hsize_t     bytes = 0;
  H5Fget_filesize(file, &bytes);
  H5Fclose(file);
  const double most = static_cast<double>(bytes) / static_cast<double>(set.getDataType().getSize()) *
                      (set.getCreatePlist().getNfilters() > 0 ? mostOfByte : 1.0);
  if (!(entries <= most))
  {
    Refuse("'", name, "' has ", entries, " entries, more than the file can hold");
  }
  return set;
}

template <typename T>
std::vector<T>
Get(const H5::Group & group, const std::string & name, Sizes & sizes)
{
  const H5::DataSet   set = Open(group, name, sizes);
  const H5::DataSpace space = set.getSpace();
  std::vector<T>      data(static_cast<std::size_t>(space.getSimpleExtentNpoints()));
  set.read(data.data(), NativeType<T>());
  return data;
}

template <typename T>
std::vector<T>
GetList(const H5::Group & group, const std::string & name, std::size_t length)
{
  Sizes          sizes;
  std::vector<T> data = Get<T>(group, name, sizes);
  if (data.size() != length)
  {
    Refuse("'", name, "' has ", data.size(), " entries where ", length, " belong");
  }
  return data;
}

Eigen::VectorXd
GetVector(const H5::Group & group, const std::string & name)
{
  Sizes                     sizes;
  const std::vector<double> data = Get<double>(group, name, sizes);
  const Eigen::VectorXd vector = Eigen::Map<const Eigen::VectorXd>(data.data(), static_cast<Eigen::Index>(data.size()));
  if (!vector.allFinite())
  {
    Refuse("'", name, "' has an entry that is not finite");
  }
  return vector;
}

Eigen::MatrixXd
GetColumns(const H5::Group & group, const std::string & name)
{
  Sizes             sizes;
  const H5::DataSet set = Open(group, name, sizes);
  if (sizes.size() != 2)
  {
    Refuse("'", name, "' is no matrix");
  }
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(sizes[1]), static_cast<Eigen::Index>(sizes[0]));
  set.read(matrix.data(), H5::PredType::NATIVE_DOUBLE);
  if (!matrix.allFinite())
  {
    Refuse("'", name, "' has an entry that is not finite");
  }
  return matrix;
}

int
GetWhole(const H5::Group & group, const std::string & name)
{
  return GetList<int>(group, name, 1).front();
}

double
GetNumber(const H5::Group & group, const std::string & name)
{
  return GetList<double>(group, name, 1).front();
}

std::string
GetText(const H5::Group & group, const std::string & name)
{
  const H5::DataSet set = group.openDataSet(name);
  std::string       text;
  set.read(text, set.getStrType());
  return text.substr(0, text.find('\0'));
}

/** What statismo 0.9 and scalismo read. */
void
PutStatismo(H5::H5File & file, const StatisticalModelContent & content)
{
  const Eigen::VectorXf mean = content.shape.mean.cast<float>();
  const auto            points = static_cast<hsize_t>(content.mean.points.size());
  const auto            modes = static_cast<hsize_t>(content.shape.GetNumberOfModes());
  H5::Group             version = file.createGroup("/version");
  PutScalar<int>(version, "majorVersion", 0);
  PutScalar<int>(version, "minorVersion", 9);

  H5::Group representer = file.createGroup("/representer");
  PutTextAttribute(representer, "name", "itkStandardMeshRepresenter");
  PutTextAttribute(representer, "version/majorVersion", "0");
  PutTextAttribute(representer, "version/minorVersion", "9");
  PutTextAttribute(representer, "datasetType", "VOLUME_MESH");
  using RowMajorFloats = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const RowMajorFloats coordinates = Eigen::Map<const Eigen::Matrix3Xf>(mean.data(), 3, mean.size() / 3);
  Put(representer, "points", coordinates.data(), { 3, points });
  std::vector<int> cells;
  for (int i = 0; i < 4; ++i)
  {
    for (const Id4 & t : content.mean.tetrahedra)
    {
      cells.push_back(t[i]);
    }
  }
  Put(representer, "cells", cells.data(), { 4, static_cast<hsize_t>(content.mean.tetrahedra.size()) });

  H5::Group model = file.createGroup("/model");
  Put(model, "mean", mean.data(), { 3 * points });
  const float noise = 0;
  Put(model, "noiseVariance", &noise, { 1 });
  const RowMajorFloats basis = content.shape.modes.cast<float>();
  Put(model, "pcaBasis", basis.data(), { 3 * points, modes });
  const Eigen::VectorXf variances = content.shape.variances.cast<float>();
  Put(model, "pcaVariance", variances.data(), { modes });

  H5::Group            info = file.createGroup("/modelinfo");
  const RowMajorFloats scores = content.shapeScores.transpose().cast<float>();
  Put(info, "scores", scores.data(), { static_cast<hsize_t>(scores.rows()), static_cast<hsize_t>(scores.cols()) });
  H5::Group builder = info.createGroup("modelBuilder-0");
  PutText(builder, "builderName", "bonetk");
  PutText(builder, "buildTime", "-");
  builder.createGroup("parameters");
  builder.createGroup("dataInfo");
}

void
PutModes(const H5::Group &       parent,
         const std::string &     name,
         const PrincipalModes &  modes,
         const Eigen::MatrixXd & scores)
{
  const H5::Group group = parent.createGroup(name);
  Put(group, "mean", modes.mean);
  PutColumns(group, "modes", modes.modes);
  Put(group, "variances", modes.variances);
  PutScalar(group, "totalVariance", modes.totalVariance);
  const Eigen::MatrixXd rows = scores.transpose();
  PutColumns(group, "scores", rows);
  if (modes.weights.size() > 0)
  {
    Put(group, "weights", modes.weights);
  }
  if (modes.block.size() > 0)
  {
    PutColumns(group, "block", modes.block);
  }
}

PrincipalModes
GetModes(const H5::Group & parent, const std::string & name, Eigen::MatrixXd & scores)
{
  const H5::Group group = parent.openGroup(name);
  PrincipalModes  modes;
  modes.mean = GetVector(group, "mean");
  modes.modes = GetColumns(group, "modes");
  modes.variances = GetVector(group, "variances");
  modes.totalVariance = GetNumber(group, "totalVariance");
  scores = GetColumns(group, "scores").transpose();
  if (group.nameExists("weights"))
  {
    modes.weights = GetVector(group, "weights");
  }
  if (group.nameExists("block"))
  {
    modes.block = GetColumns(group, "block");
  }
  if (modes.variances.size() > 0 && !(modes.variances.minCoeff() > 0))
  {
    Refuse("'", name, "' has a variance that is not above 0");
  }
  return modes;
}

void
PutInts(const H5::Group & group, const std::string & name, const std::vector<int> & list)
{
  if (!list.empty())
  {
    Put(group, name, list.data(), { static_cast<hsize_t>(list.size()) });
  }
}

void
PutModel(H5::H5File & file, const StatisticalModelContent & content)
{
  const H5::Group    group = file.createGroup("/bonetk");
  const MeshArrays & mean = content.mean;
  PutScalar<int>(group, "version", LayoutVersion);
  PutScalar<int>(group, "similarity", content.similarity ? 1 : 0);
  PutScalar<int>(group, "degree", mean.maximumDegree);
  PutScalar<int>(group, "quantity", static_cast<int>(mean.quantity));
  static_assert(sizeof(Id4) == 4 * sizeof(int), "ids are ints");
  Put(group, "tetrahedra", mean.tetrahedra.front().data(), { static_cast<hsize_t>(mean.tetrahedra.size()), 4 });
  PutInts(group, "region", mean.region);
  PutInts(group, "layer", mean.layer);
  PutInts(group, "slice", mean.slice);
  PutModes(group, "shape", content.shape, content.shapeScores);
  if (content.density.GetDimension() > 0)
  {
    PutModes(group, "density", content.density, content.densityScores);
  }
  if (content.combined.variances.size() > 0)
  {
    const H5::Group combined = group.createGroup("combined");
    PutColumns(combined, "vectors", content.combined.vectors);
    Put(combined, "variances", content.combined.variances);
    PutScalar(combined, "shapeWeight", content.combined.shapeWeight);
  }
  const H5::Group subjects = group.createGroup("subjects");
  PutScalar<int>(subjects, "count", static_cast<int>(content.subjects.size()));
  for (std::size_t i = 0; i < content.subjects.size(); ++i)
  {
    PutText(subjects, std::to_string(i), content.subjects[i]);
  }
}

/** Topology and attributes of the mean, and its points. */
MeshArrays
GetMean(const H5::Group & group, const Eigen::VectorXd & shape)
{
  MeshArrays mean;
  mean.points = UnstackPoints(shape);
  Sizes                  sizes;
  const std::vector<int> ids = Get<int>(group, "tetrahedra", sizes);
  if (sizes.size() != 2 || sizes[1] != 4 || ids.empty() || shape.size() % 3 != 0)
  {
    Refuse("'tetrahedra' is no list of four ids each, or 'shape' no list of points");
  }
  mean.tetrahedra.resize(ids.size() / 4);
  for (std::size_t i = 0; i < ids.size(); ++i)
  {
    if (ids[i] < 0 || static_cast<std::size_t>(ids[i]) >= mean.points.size())
    {
      Refuse("tetrahedron ", i / 4, " names point ", ids[i], " where there are ", mean.points.size(), " points");
    }
    mean.tetrahedra[i / 4][i % 4] = ids[i];
  }
  mean.neighbors = ComputeFaceNeighbors(mean.tetrahedra);
  mean.region = group.nameExists("region") ? GetList<int>(group, "region", mean.tetrahedra.size()) : std::vector<int>();
  mean.layer = group.nameExists("layer") ? GetList<int>(group, "layer", mean.points.size()) : std::vector<int>();
  mean.slice = group.nameExists("slice") ? GetList<int>(group, "slice", mean.points.size()) : std::vector<int>();
  return mean;
}

StatisticalModelContent
GetModel(const H5::H5File & file)
{
  const H5::Group group = file.openGroup("/bonetk");
  if (const int version = GetWhole(group, "version"); version != LayoutVersion)
  {
    Refuse("has version ", version, " of the layout; this program reads version ", LayoutVersion);
  }
  StatisticalModelContent content;
  content.shape = GetModes(group, "shape", content.shapeScores);
  content.mean = GetMean(group, content.shape.mean);
  content.similarity = GetWhole(group, "similarity") != 0;
  if (group.nameExists("density"))
  {
    MeshArrays & mean = content.mean;
    content.density = GetModes(group, "density", content.densityScores);
    mean.maximumDegree = GetWhole(group, "degree");
    mean.quantity = static_cast<DensityQuantity>(GetWhole(group, "quantity"));
    if (mean.maximumDegree < 0 || mean.maximumDegree > MaximumBernsteinDegree)
    {
      Refuse("has density of degree ", mean.maximumDegree, ", which must be from 0 to ", MaximumBernsteinDegree);
    }
    const auto expected = mean.tetrahedra.size() * static_cast<std::size_t>(BernsteinCount(mean.maximumDegree));
    if (static_cast<std::size_t>(content.density.mean.size()) != expected)
    {
      Refuse("has ", content.density.mean.size(), " density coefficients where ", expected, " belong");
    }
    mean.degree.assign(mean.tetrahedra.size(), mean.maximumDegree);
    mean.coefficients.assign(content.density.mean.data(), content.density.mean.data() + content.density.mean.size());
  }
  if (group.nameExists("combined"))
  {
    const H5::Group combined = group.openGroup("combined");
    content.combined.vectors = GetColumns(combined, "vectors");
    content.combined.variances = GetVector(combined, "variances");
    content.combined.shapeWeight = GetNumber(combined, "shapeWeight");
  }
  const H5::Group subjects = group.openGroup("subjects");
  const int       count = GetWhole(subjects, "count");
  for (int i = 0; i < count; ++i)
  {
    content.subjects.push_back(GetText(subjects, std::to_string(i)));
  }
  return content;
}

/** HDF5 crashes in some files of which bytes are missing or doubled, and reads the names of a group into memory without
 * a look at whether there is that much. Throws where the file is not as long as its superblock says (version 0 or 1,
 * which are written; HDF5 file format specification, II.A), or a local heap (III.D) lies beyond it. */
void
RequireWholeHdf5File(const std::string & path)
{
  constexpr std::size_t header = 32;
  const std::string     bytes = [&path] {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  }();
  const auto damaged = [] { Refuse("is no statistical model of BoneTK, or cut short or damaged"); };
  const auto number = [&bytes](std::size_t at) {
    std::uint64_t value = 0;
    std::memcpy(&value, &bytes[at], sizeof(value));
    return value;
  };
  constexpr std::size_t superblock = 96;
  const bool            first = bytes.size() > superblock && bytes.compare(1, 3, "HDF") == 0 && bytes[8] <= 1;
  const std::size_t     sizes = first && bytes[8] == 1 ? 28 : 24; // version 1 has four bytes more
  if (first && number(sizes) == 0 && number(sizes + 16) != bytes.size())
  {
    damaged();
  }
  const std::string signature("HEAP\0\0\0\0", 8);
  for (std::size_t at = bytes.find(signature); at != std::string::npos && at + header <= bytes.size();
       at = bytes.find(signature, at + 1))
  {
    const std::uint64_t size = number(at + 8);
    if (size > bytes.size() || number(at + 24) > bytes.size() - size)
    {
      damaged();
    }
  }
}

/** Runs action() and turns HDF5's exceptions into TError. */
template <typename TError, typename TAction>
auto
NamingHdf5File(const std::string & path, const std::string & problem, TAction && action)
{
  H5::Exception::dontPrint();
  try
  {
    return NamingFile(path, action);
  }
  catch (const H5::Exception &)
  {
    throw TError(path, problem); // what HDF5 says is about its own functions
  }
}
} // namespace

void
WriteStatisticalModel(const StatisticalModel * model, const std::string & path)
{
  RequireExtension(path, { ".h5" });
  if (model->GetContent().mean.tetrahedra.empty())
  {
    throw IOError(path, "the statistical model to write is empty");
  }
  AtomicFile file(path);
  NamingHdf5File<MachineError>(path, "cannot be written (is the disk full?)", [&] {
    H5::H5File hdf5(file.GetTemporaryPath(), H5F_ACC_TRUNC);
    PutStatismo(hdf5, model->GetContent());
    PutModel(hdf5, model->GetContent());
  });
  file.Commit();
}

void
WriteMatrices(const std::vector<std::pair<std::string, Eigen::MatrixXd>> & matrices, const std::string & path)
{
  RequireExtension(path, { ".h5" });
  AtomicFile file(path);
  NamingHdf5File<MachineError>(path, "cannot be written (is the disk full?)", [&] {
    H5::H5File hdf5(file.GetTemporaryPath(), H5F_ACC_TRUNC);
    for (const auto & [name, matrix] : matrices)
    {
      PutColumns(hdf5, name, matrix.transpose());
    }
  });
  file.Commit();
}

StatisticalModel::Pointer
ReadStatisticalModel(const std::string & path)
{
  RequireReadableFile(path);
  RequireExtension(path, { ".h5" });
  return NamingHdf5File<IOError>(path, "is no statistical model of BoneTK, or cut short or damaged", [&] {
    RequireWholeHdf5File(path);
    auto model = StatisticalModel::New();
    model->SetContent(GetModel(H5::H5File(path, H5F_ACC_RDONLY)));
    return model;
  });
}

void
FileTrainingSet::AddSubject(const std::string & name, const std::string & path)
{
  m_Subjects.emplace_back(name, path);
  this->Modified();
}

MeshArrays
FileTrainingSet::GetSubject(std::size_t subject) const
{
  return ReadMeshArrays(m_Subjects.at(subject).second);
}
} // namespace bone
