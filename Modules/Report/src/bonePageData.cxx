/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePageData.h"

#include "bonePageParts.h"

#include "boneBernstein.h"
#include "boneDensityEvaluation.h"

#include <vtkBase64Utilities.h>

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace bone
{
namespace
{
/** The bytes of numbers of `size` bytes each: the first ones of all numbers, the second ones of all, and so on, each
 * number less the one `delta` places before. */
std::string
BytePlanes(const std::vector<std::int64_t> & raw, std::size_t size, std::size_t delta)
{
  std::string bytes(raw.size() * size, '\0');
  for (std::size_t i = 0; i < raw.size(); ++i)
  {
    const std::int64_t before = delta > 0 && i >= delta ? raw[i - delta] : 0;
    const auto         number = static_cast<std::uint64_t>(raw[i] - before);
    for (std::size_t b = 0; b < size; ++b)
    {
      bytes[b * raw.size() + i] = static_cast<char>((number >> (8 * b)) & 0xff);
    }
  }
  return bytes;
}

nlohmann::json
PackRaw(const std::vector<std::int64_t> & raw, std::size_t delta)
{
  std::int64_t lower = 0, upper = 0;
  for (const std::int64_t x : raw)
  {
    lower = std::min(lower, x);
    upper = std::max(upper, x);
  }
  std::size_t size = 1;
  const auto  fits = [&] {
    const std::int64_t half = std::int64_t{ 1 } << (8 * size - 1);
    return lower < 0 ? lower >= -half && upper < half : upper < 2 * half;
  };
  while (!fits())
  {
    size *= 2;
    if (size > 4)
    {
      throw std::invalid_argument("a number has more than 32 bits");
    }
  }
  nlohmann::json array = { { "type", (lower < 0 ? "int" : "uint") + std::to_string(8 * size) },
                           { "length", raw.size() },
                           { "data", ToBase64(Gzip(BytePlanes(raw, size, delta))) } };
  if (size > 1)
  {
    array["planes"] = true;
  }
  if (delta > 0)
  {
    array["delta"] = delta;
  }
  return array;
}

std::vector<double>
Coordinates(const std::vector<Vector3> & points)
{
  std::vector<double> numbers;
  numbers.reserve(3 * points.size());
  for (const Vector3 & x : points)
  {
    numbers.insert(numbers.end(), x.data(), x.data() + 3);
  }
  return numbers;
}

/** Points to a 65,000th of their longest side. */
nlohmann::json
PackPoints(const std::vector<Vector3> & points)
{
  Vector3 lower = points.empty() ? Vector3(Vector3::Zero()) : points.front(), upper = lower;
  for (const Vector3 & x : points)
  {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const double side = std::max((upper - lower).maxCoeff(), 1e-6);
  return PackNumbers(Coordinates(points), side / 65535.0, { lower.x(), lower.y(), lower.z() }, 3);
}

/** The coefficients that the mesh's polynomials have, in one row. */
template <typename TVisit>
void
VisitCoefficients(const MeshCells & mesh, const TVisit & visit)
{
  const auto row = static_cast<std::size_t>(BernsteinCount(mesh.maximumDegree));
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const auto count = static_cast<std::size_t>(BernsteinCount(mesh.degree[t]));
    for (std::size_t k = 0; k < count; ++k)
    {
      visit(t * row + k);
    }
  }
}

std::array<double, 2>
Percentiles(std::vector<double> values, double share)
{
  if (values.empty())
  {
    return { { 0.0, 1.0 } };
  }
  const auto at = [&](double s) {
    const auto k = static_cast<std::ptrdiff_t>(s * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<std::size_t>(k)];
  };
  return { { at(share), at(1.0 - share) } };
}

std::vector<double>
UsedCoefficients(const MeshCells & mesh)
{
  std::vector<double> used;
  if (mesh.HasDensity())
  {
    VisitCoefficients(mesh, [&](std::size_t k) { used.push_back(mesh.coefficients[k]); });
  }
  return used;
}

double
StepOf(const std::vector<double> & values)
{
  const auto   range = Percentiles(values, 0.01);
  const double largest =
    values.empty() ? 0.0 : std::abs(*std::max_element(values.begin(), values.end(), [](double a, double b) {
      return std::abs(a) < std::abs(b);
    }));
  // At most 31 bits, however far a single coefficient lies.
  return std::max({ 2e-3 * (range[1] - range[0]), 1e-9 * largest, 1e-12 });
}

nlohmann::json
PackRegions(const MeshCells & mesh)
{
  std::vector<IdType> region(mesh.region.begin(), mesh.region.end());
  region.resize(mesh.tetrahedra.size(), 0);
  return PackIds(region, 0);
}

nlohmann::json
RegionNames(const MeshCells & mesh)
{
  nlohmann::json names = nlohmann::json::object();
  for (const int region : mesh.region)
  {
    names[std::to_string(region)] = RegionName(region);
  }
  return names;
}

nlohmann::json
PackContours(const ContourStack & stack)
{
  struct Lines
  {
    ContourStyle         style;
    std::vector<IdType>  counts, closed;
    std::vector<Vector3> points;
  };
  std::map<std::string, Lines> kinds;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      const ContourStyle style = StyleOf(contour);
      Lines &            lines = kinds[style.name];
      lines.style = style;
      lines.counts.push_back(static_cast<IdType>(contour.points.size()));
      lines.closed.push_back(contour.axis ? 0 : 1);
      lines.points.insert(lines.points.end(), contour.points.begin(), contour.points.end());
    }
  }
  nlohmann::json packed = nlohmann::json::array();
  for (const auto & [name, lines] : kinds)
  {
    packed.push_back({ { "name", name },
                       { "color", ToHex(lines.style.color) },
                       { "counts", PackIds(lines.counts, 0) },
                       { "closed", PackIds(lines.closed, 0) },
                       { "points", PackPoints(lines.points) } });
  }
  return packed;
}

/** Members that models and atlases share. */
nlohmann::json
DescribeDensity(const MeshCells & mesh)
{
  nlohmann::json json = { { "unit", DensityUnitName(mesh.quantity) },
                          { "quantity", "density" },
                          { "regions", RegionNames(mesh) } };
  const auto     range = Percentiles(UsedCoefficients(mesh), 0.02);
  json["range"] = { range[0], std::max(range[1], range[0] + 1e-9) };
  return json;
}

nlohmann::json
VectorJson(const Vector3 & v)
{
  return { v.x(), v.y(), v.z() };
}

/** The first modes, each as its change at +1 standard deviation. */
template <typename TPack>
nlohmann::json
PackModes(const PrincipalModes & modes, std::size_t most, const char * member, const TPack & pack)
{
  nlohmann::json packed = nlohmann::json::array();
  const auto     count = std::min(most, static_cast<std::size_t>(modes.GetNumberOfModes()));
  for (std::size_t k = 0; k < count; ++k)
  {
    const auto            column = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd change = std::sqrt(modes.variances[column]) * modes.modes.col(column);
    packed.push_back({ { "share", modes.totalVariance > 0.0 ? modes.variances[column] / modes.totalVariance : 0.0 },
                       { member, pack(change) } });
  }
  return packed;
}
} // namespace

std::string
ToBase64(const std::string & bytes)
{
  std::string text(4 * ((bytes.size() + 2) / 3) + 4, '\0');
  const auto  length = vtkBase64Utilities::Encode(
    reinterpret_cast<const unsigned char *>(bytes.data()), bytes.size(), reinterpret_cast<unsigned char *>(&text[0]));
  text.resize(length);
  return text;
}

std::string
Gzip(const std::string & bytes)
{
  constexpr int gzip = 15 + 16; // the largest window, in gzip's format
  z_stream      stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, gzip, 9, Z_FILTERED) != Z_OK)
  {
    throw std::runtime_error("zlib cannot begin to compress");
  }
  std::string packed(deflateBound(&stream, bytes.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef *>(&packed[0]);
  stream.avail_out = static_cast<uInt>(packed.size());
  const int result = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (result != Z_STREAM_END)
  {
    throw std::runtime_error("zlib cannot compress");
  }
  return packed;
}

nlohmann::json
PackNumbers(const std::vector<double> & values, double step, const std::vector<double> & offsets, std::size_t delta)
{
  if (!(step > 0.0) || offsets.empty())
  {
    throw std::invalid_argument("numbers need a positive step and an offset");
  }
  std::vector<std::int64_t> raw;
  raw.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const double number = (values[i] - offsets[i % offsets.size()]) / step;
    if (!(std::abs(number) < 2147483647.0))
    {
      throw std::invalid_argument("a value is not finite, or too large for its step");
    }
    raw.push_back(std::llround(number));
  }
  nlohmann::json array = PackRaw(raw, delta);
  array["step"] = step;
  array["offset"] = offsets;
  return array;
}

nlohmann::json
PackIds(const std::vector<IdType> & ids, std::size_t delta)
{
  return PackRaw(std::vector<std::int64_t>(ids.begin(), ids.end()), delta);
}

double
PictureStep(const MeshArrays & mesh)
{
  return StepOf(UsedCoefficients(mesh));
}

nlohmann::json
PackLevel(const std::string & name, const MeshArrays & mesh, double coefficientStep)
{
  std::vector<IdType> ids;
  ids.reserve(4 * mesh.tetrahedra.size());
  for (const Id4 & t : mesh.tetrahedra)
  {
    ids.insert(ids.end(), t.begin(), t.end());
  }
  nlohmann::json level = { { "name", name },
                           { "points", PackPoints(mesh.points) },
                           { "tetrahedra", PackIds(ids, 4) },
                           { "regions", PackRegions(mesh) } };
  if (mesh.HasDensity())
  {
    level["degrees"] = PackIds(std::vector<IdType>(mesh.degree.begin(), mesh.degree.end()), 0);
    level["coefficients"] = PackNumbers(UsedCoefficients(mesh), coefficientStep, { 0.0 }, 0);
  }
  return level;
}

nlohmann::json
PackModel(const std::vector<NamedMesh> & levels,
          const ContourStack *           contours,
          const std::vector<Landmark> &  landmarks,
          const nlohmann::json &         finest)
{
  nlohmann::json model = DescribeDensity(*levels.front().mesh);
  const double   step = PictureStep(*levels.front().mesh);
  for (const NamedMesh & level : levels)
  {
    const bool packed = &level == &levels.front() && !finest.is_null();
    model["levels"].push_back(packed ? finest : PackLevel(level.name, *level.mesh, step));
  }
  if (contours != nullptr)
  {
    model["contours"] = PackContours(*contours);
  }
  for (const Landmark & landmark : landmarks)
  {
    model["landmarks"].push_back({ { "name", landmark.name }, { "position", VectorJson(landmark.point) } });
  }
  return model;
}

nlohmann::json
PackAtlas(const StatisticalModel & model, std::size_t modes, const XRayGeometry::View & view)
{
  const StatisticalModelContent & content = model.GetContent();
  nlohmann::json                  atlas = DescribeDensity(content.mean);
  atlas["mean"] = PackLevel("mean", content.mean, PictureStep(content.mean));
  atlas["shape"] = PackModes(content.shape, modes, "displacements", [](const Eigen::VectorXd & change) {
    const std::vector<double> values(change.data(), change.data() + change.size());
    return PackNumbers(values, std::max(1e-6, change.cwiseAbs().maxCoeff() / 30000.0), { 0.0 }, 3);
  });
  atlas["density"] = PackModes(content.density, modes, "coefficients", [&content](const Eigen::VectorXd & change) {
    std::vector<double> values;
    VisitCoefficients(content.mean, [&](std::size_t k) { values.push_back(change[static_cast<Eigen::Index>(k)]); });
    return PackNumbers(values, StepOf(values), { 0.0 }, 0);
  });
  atlas["view"] = { { "source", VectorJson(view.source) },
                    { "detectorOrigin", VectorJson(view.detectorOrigin) },
                    { "detectorU", VectorJson(view.detectorU) },
                    { "detectorV", VectorJson(view.detectorV) },
                    { "size", view.size },
                    { "spacing", { view.spacing.x(), view.spacing.y() } } };
  atlas["letters"] = PackLetters(LettersOf(view.detectorU, view.detectorV));
  return atlas;
}
} // namespace bone
