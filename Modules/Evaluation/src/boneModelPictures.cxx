/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelPictures.h"

#include "boneDRRImageFilter.h"
#include "boneDensityEvaluation.h"
#include "boneFigure.h"
#include "boneTicks.h"
#include "boneXRayPicture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr int Side = 420; // pixels of a panel's longer side

/** Size of what is looked at, across and up, mm. */
struct Extent
{
  Vector3 centre;
  double  across;
  double  height;
};

Extent
FindExtent(const std::vector<std::vector<Vector3>> & shapes, const Vector3 & right, const Vector3 & up)
{
  const double big = std::numeric_limits<double>::max();
  Vector3      lower(big, big, big), upper(-big, -big, -big);
  Vector2      low(big, big), high(-big, -big);
  for (const auto & points : shapes)
  {
    for (const Vector3 & x : points)
    {
      lower = lower.cwiseMin(x);
      upper = upper.cwiseMax(x);
      const Vector2 p(x.dot(right), x.dot(up));
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  Vector3 centre = 0.5 * (lower + upper);
  centre += (0.5 * (low[0] + high[0]) - centre.dot(right)) * right + (0.5 * (low[1] + high[1]) - centre.dot(up)) * up;
  return { centre, high[0] - low[0], high[1] - low[1] };
}

void
FillTriangle(const std::array<Vector3, 3> & p, float value, Panel & panel, std::vector<double> & depth)
{
  const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
  if (!(std::abs(area) > 0))
  {
    return;
  }
  const auto range = [&p](int axis, int size) {
    const auto [low, high] = std::minmax({ p[0][axis], p[1][axis], p[2][axis] });
    return std::make_pair(std::max(0, static_cast<int>(std::ceil(low))),
                          std::min(size - 1, static_cast<int>(std::floor(high))));
  };
  const auto [left, right] = range(0, panel.columns);
  const auto [top, bottom] = range(1, panel.rows);
  for (int row = top; row <= bottom; ++row)
  {
    for (int column = left; column <= right; ++column)
    {
      double w[3];
      for (int i = 0; i < 3; ++i)
      {
        const Vector3 &a = p[(i + 1) % 3], &b = p[(i + 2) % 3];
        w[i] = ((b[0] - a[0]) * (row - a[1]) - (column - a[0]) * (b[1] - a[1])) / area;
      }
      if (w[0] < 0 || w[1] < 0 || w[2] < 0)
      {
        continue;
      }
      const double z = w[0] * p[0][2] + w[1] * p[1][2] + w[2] * p[2][2];
      double &     nearest = depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(panel.columns) +
                               static_cast<std::size_t>(column)];
      if (z < nearest)
      {
        nearest = z;
        panel.At(column, row) = value;
      }
    }
  }
}

/** Coefficients with one mode at sd standard deviations. */
Eigen::VectorXd
OneMode(int mode, double sd)
{
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(mode + 1);
  coefficients[mode] = sd;
  return coefficients;
}

std::string
Title(const std::string & kind, int mode, double sd)
{
  return kind + " mode " + std::to_string(mode + 1) + (sd < 0 ? ", \u22123 SD" : sd > 0 ? ", +3 SD" : ", mean");
}

Panel
Radiograph(const MeshArrays & mesh, const XRayGeometry * geometry)
{
  auto model = DensityMesh<double>::New();
  model->SetArrays(mesh);
  auto filter = DRRImageFilter<DensityMesh<double>, CTImage>::New();
  filter->SetInput(model);
  filter->SetGeometry(geometry);
  filter->Update();
  return ToPanel(filter->GetOutput());
}
} // namespace

Panel
ShadeSurface(const TriangleSurface & surface,
             const Vector3 &         centre,
             const Vector3 &         direction,
             const Vector3 &         up,
             double                  pixel,
             int                     columns,
             int                     rows)
{
  Panel panel;
  panel.columns = columns;
  panel.rows = rows;
  const auto size = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  panel.values.assign(size, std::numeric_limits<float>::quiet_NaN());
  std::vector<double> depth(size, std::numeric_limits<double>::max());
  const Vector3       right = direction.cross(up);
  const auto          normals = PointNormals(surface);
  for (const auto & t : surface.triangles)
  {
    std::array<Vector3, 3> p;
    Vector3                normal = Vector3::Zero();
    for (int i = 0; i < 3; ++i)
    {
      const Vector3 x = surface.points[t[i]] - centre;
      p[i] = Vector3(0.5 * columns + x.dot(right) / pixel, 0.5 * rows - x.dot(up) / pixel, x.dot(direction));
      normal += normals[t[i]];
    }
    const Vector3 light = (-direction + 0.5 * up - 0.3 * right).normalized();
    FillTriangle(p, static_cast<float>(0.15 + 0.85 * std::max(0.0, normal.normalized().dot(light))), panel, depth);
  }
  return panel;
}

Canvas
DrawShapeModes(const StatisticalModel & model, int modes, const Vector3 & direction, const Vector3 & up, bool letters)
{
  const auto & content = model.GetContent();
  modes = std::min(modes, static_cast<int>(content.shape.GetNumberOfModes()));
  if (modes < 1)
  {
    throw std::invalid_argument("A model without modes of shape has none to draw.");
  }
  std::vector<IdType>               id;
  TriangleSurface                   surface = ExteriorSurface(content.mean, id);
  std::vector<std::vector<Vector3>> shapes;
  for (int mode = 0; mode < modes; ++mode)
  {
    for (const double sd : { -3.0, 0.0, 3.0 })
    {
      shapes.push_back(UnstackPoints(content.shape.Synthesize(OneMode(mode, sd))));
    }
  }
  const Vector3 right = direction.cross(up);
  const Extent  extent = FindExtent(shapes, right, up);
  const double  pixel = 1.05 * std::max(extent.across, extent.height) / Side;
  const int     columns = static_cast<int>(std::ceil(1.05 * extent.across / pixel)) + 20;
  const int     rows = static_cast<int>(std::ceil(1.05 * extent.height / pixel));
  Figure        figure;
  figure.sections.emplace_back().rows.resize(static_cast<std::size_t>(modes));
  for (std::size_t i = 0; i < shapes.size(); ++i)
  {
    for (std::size_t p = 0; p < id.size(); ++p)
    {
      surface.points[p] = shapes[i][id[p]];
    }
    PanelCell cell;
    cell.panel = ShadeSurface(surface, extent.centre, direction, up, pixel, columns, rows);
    cell.style.title = Title("shape", static_cast<int>(i / 3), 3.0 * (static_cast<double>(i % 3) - 1.0));
    cell.style.letters = letters ? LettersOf(right, -up) : SideLetters();
    cell.style.pixelSize = Vector2::Constant(pixel);
    cell.style.window = { 0.0, 1.1 };
    figure.sections[0].rows[i / 3].push_back(std::move(cell));
  }
  return DrawFigure(figure);
}

Canvas
DrawRadiographModes(const StatisticalModel & model, const Vector3 & direction, const Vector3 & up, bool letters)
{
  const Eigen::VectorXd                                        none;
  std::vector<std::pair<std::string, std::vector<MeshArrays>>> kinds;
  if (model.GetContent().shape.GetNumberOfModes() > 0)
  {
    kinds.push_back({ "shape", {} });
  }
  if (model.GetContent().density.GetNumberOfModes() > 0)
  {
    kinds.push_back({ "density", {} });
  }
  if (kinds.empty())
  {
    throw std::invalid_argument("A model without modes has none to draw.");
  }
  Vector3 lower = model.GetContent().mean.points.front(), upper = lower;
  for (auto & [kind, meshes] : kinds)
  {
    for (const double sd : { -3.0, 0.0, 3.0 })
    {
      const Eigen::VectorXd mode = OneMode(0, sd);
      meshes.push_back(kind == "shape" ? model.Synthesize(mode) : model.Synthesize(none, mode));
      for (const Vector3 & x : meshes.back().points)
      {
        lower = lower.cwiseMin(x);
        upper = upper.cwiseMax(x);
      }
    }
  }
  auto geometry = XRayGeometry::New();
  geometry->SetView(XRayGeometry::Framing(lower, upper, direction, up, Side));
  const Panel  mean = Radiograph(kinds[0].second[1], geometry);
  const double brightest = *std::max_element(mean.values.begin(), mean.values.end());
  const double white = RoundInRange(brightest, brightest);

  PanelStyle style;
  style.letters = letters ? LettersOf(geometry->GetView()) : SideLetters();
  style.pixelSize = PixelSizeAt(geometry->GetView(), 0.5 * (lower + upper));
  style.scaleNote = "at the bone";
  style.unit = DensityUnitName(model.GetContent().mean.quantity) + "\u00B7mm";
  style.colorBar = true;
  Figure figure;
  figure.sections.emplace_back();
  for (const auto & [kind, meshes] : kinds)
  {
    std::vector<PanelCell> row, differences;
    for (int i = 0; i < 3; ++i)
    {
      PanelCell cell{ Radiograph(meshes[static_cast<std::size_t>(i)], geometry), style, {} };
      cell.style.title = Title(kind, 0, 3.0 * (i - 1));
      cell.style.window = { 0.0, white };
      row.push_back(cell);
      for (std::size_t k = 0; k < cell.panel.values.size(); ++k)
      {
        cell.panel.values[k] -= mean.values[k];
      }
      cell.style.title += " \u2212 mean";
      cell.style.map = ColorMap::Diverging;
      cell.style.window = { -0.5 * white, 0.5 * white };
      if (i != 1)
      {
        differences.push_back(std::move(cell));
      }
    }
    row.insert(row.end(), differences.begin(), differences.end());
    figure.sections[0].rows.push_back(std::move(row));
  }
  return DrawFigure(figure);
}
} // namespace bone
