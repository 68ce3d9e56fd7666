/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourIO.h"

#include "boneAtomicFile.h"
#include "boneContourImage.h"
#include "boneDicomFile.h"
#include "boneMarkups.h"
#include "bonePolylines.h"
#include "boneStructureSet.h"
#include "boneVtkArrays.h"
#include "boneVtkFile.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTypeInt64Array.h>

#include <Eigen/Geometry>

namespace bone
{
namespace
{
constexpr long long Highest = std::numeric_limits<int>::max();

// Whole numbers of the cells, or none where the file has no such array.
std::vector<int>
CellNumbers(vtkPolyData * data, const char * name, long long lowest)
{
  vtkDataArray * array = FindArray(data->GetCellData(), name, data->GetNumberOfCells(), 1);
  return array != nullptr ? WholeNumbers(array, lowest, Highest) : std::vector<int>();
}

// Clearances of an axis's points, where the file has them.
std::vector<double>
CellClearance(vtkDataArray * clearance, vtkCellArray * cells, vtkIdType cell)
{
  std::vector<double> values;
  if (clearance != nullptr)
  {
    vtkIdType         size = 0;
    const vtkIdType * ids = nullptr;
    cells->GetCellAtId(cell, size, ids);
    for (vtkIdType i = 0; i < size; ++i)
    {
      values.push_back(clearance->GetComponent(ids[i], 0));
      if (!(values.back() >= 0.0) || !std::isfinite(values.back()))
      {
        Refuse("'Clearance' of point ", ids[i], " is ", values.back(), "; it must be 0 or more");
      }
    }
  }
  return values;
}

std::vector<Vector3>
CellPoints(vtkPolyData * data, vtkCellArray * cells, vtkIdType cell)
{
  vtkIdType         size = 0;
  const vtkIdType * ids = nullptr;
  cells->GetCellAtId(cell, size, ids);
  std::vector<Vector3> points(static_cast<std::size_t>(size));
  for (vtkIdType i = 0; i < size; ++i)
  {
    if (ids[i] < 0 || ids[i] >= data->GetNumberOfPoints())
    {
      Refuse("a polyline names point ", ids[i], " where there are ", data->GetNumberOfPoints(), " points");
    }
    data->GetPoint(ids[i], points[i].data());
    RequireSensible(points[i], static_cast<std::size_t>(ids[i]));
  }
  return points;
}

void
RequireEnoughPoints(const Contour & contour, std::size_t cell)
{
  if (contour.points.empty() || (!contour.axis && contour.points.size() < 3))
  {
    Refuse("polyline ",
           cell,
           " has ",
           contour.points.size(),
           " points; a contour is one closed polyline of three points or more, not separate segments");
  }
}

std::vector<Polyline>
ReadPolylines(vtkPolyData * data)
{
  if (data->GetNumberOfStrips() > 0)
  {
    Refuse("holds triangle strips; contours are closed polylines");
  }
  const auto slice = CellNumbers(data, "Slice", 0);
  const auto layer = CellNumbers(data, "Layer", 0);
  const auto id = CellNumbers(data, "Contour", 0);
  const auto region = CellNumbers(data, "Region", 0);
  const auto axis = CellNumbers(data, "Axis", 0);
  auto *     clearance = FindArray(data->GetPointData(), "Clearance", data->GetNumberOfPoints(), 1);

  std::vector<Polyline> polylines;
  for (vtkCellArray * cells : { data->GetVerts(), data->GetLines(), data->GetPolys() })
  {
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c)
    {
      const std::size_t cell = polylines.size();
      Polyline          polyline;
      Contour &         contour = polyline.contour;
      contour.points = CellPoints(data, cells, c);
      contour.axis = !axis.empty() && axis[cell] != 0;
      // A closed line may end in its first point; an axis of one point is written as a line from that point to itself.
      const bool repeats = contour.points.size() > 1 && contour.points.front() == contour.points.back();
      if (repeats && (!contour.axis || contour.points.size() == 2))
      {
        contour.points.pop_back();
      }
      if (contour.axis)
      {
        contour.clearance = CellClearance(clearance, cells, c);
        contour.clearance.resize(contour.clearance.empty() ? 0 : contour.points.size());
      }
      RequireEnoughPoints(contour, cell);
      contour.layer = layer.empty() ? 0 : layer[cell];
      polyline.slice = slice.empty() ? -1 : slice[cell];
      polyline.hasId = !id.empty();
      contour.id = id.empty() ? 0 : id[cell];
      polyline.hasRegion = !region.empty();
      contour.region = region.empty() ? contour.layer + 1 : region[cell];
      polylines.push_back(std::move(polyline));
    }
  }
  return polylines;
}

// A vector of the field data, or zero.
Vector3
FieldVector(vtkPolyData * data, const char * name)
{
  vtkAbstractArray * any = data->GetFieldData()->GetAbstractArray(name);
  if (any == nullptr || any->GetNumberOfTuples() == 0)
  {
    return Vector3::Zero();
  }
  vtkDataArray * array = FindArray(data->GetFieldData(), name, any->GetNumberOfTuples(), 3);
  Vector3        vector;
  array->GetTuple(0, vector.data());
  if (!vector.allFinite() || !(vector.norm() > 0))
  {
    Refuse("'", name, "' must be a finite vector other than zero");
  }
  for (vtkIdType i = 1; i < array->GetNumberOfTuples(); ++i)
  {
    Vector3 other;
    array->GetTuple(i, other.data());
    if (!((other - vector).norm() <= 1e-6 * vector.norm()))
    {
      Refuse("'", name, "' differs between slices: the slices must be parallel");
    }
  }
  return vector;
}

bool
FieldFlag(vtkPolyData * data, const char * name)
{
  vtkDataArray * array = FindArray(data->GetFieldData(), name, 1, 1);
  return array != nullptr && WholeNumber(array, 0, 0, 0, 1) == 1;
}

// The stack of a file that gives its planes: slices without contours are kept.
ContourStack::Pointer
StackOnPlanes(vtkPolyData *         data,
              std::vector<Polyline> polylines,
              vtkDataArray *        origins,
              const Vector3 &       normal,
              const Vector3 &       u)
{
  auto stack = ContourStack::New();
  if (u.isZero(0))
  {
    SetFrameFromNormal(stack, normal);
  }
  else
  {
    stack->SetFrame(u, normal.cross(u));
  }
  ContourStack::SliceContainer slices(static_cast<std::size_t>(origins->GetNumberOfTuples()));
  for (std::size_t k = 0; k < slices.size(); ++k)
  {
    origins->GetTuple(static_cast<vtkIdType>(k), slices[k].origin.data());
  }
  for (auto & polyline : polylines)
  {
    if (polyline.slice < 0 || static_cast<std::size_t>(polyline.slice) >= slices.size())
    {
      Refuse("a polyline is on slice ", polyline.slice, " where there are ", slices.size(), " slice origins");
    }
    slices[polyline.slice].contours.push_back(std::move(polyline.contour));
  }
  stack->SetSlices(std::move(slices));
  stack->SetOpenStart(FieldFlag(data, "OpenStart"));
  stack->SetOpenEnd(FieldFlag(data, "OpenEnd"));
  return stack;
}

ContourStack::Pointer
ToContourStack(vtkPolyData * data)
{
  auto          polylines = ReadPolylines(data);
  const Vector3 normal = FieldVector(data, "SliceNormal");
  const Vector3 u = normal.isZero(0) ? normal : FieldVector(data, "SliceU");
  auto *        any = data->GetFieldData()->GetAbstractArray("SliceOrigin");
  const bool    numbered = data->GetCellData()->HasArray("Slice") && data->GetCellData()->HasArray("Region") &&
                        data->GetCellData()->HasArray("Contour");
  if (any == nullptr || normal.isZero(0) || !numbered)
  {
    return StackPolylines(std::move(polylines), normal, u);
  }
  vtkDataArray * origins = FindArray(data->GetFieldData(), "SliceOrigin", any->GetNumberOfTuples(), 3);
  return StackOnPlanes(data, std::move(polylines), origins, normal, u);
}

void
AddField(vtkPolyData * data, const ContourStack * stack)
{
  const auto & slices = stack->GetSlices();
  auto *       field = data->GetFieldData();
  const auto   addVector = [field](const char * name, const Vector3 & v) {
    field->AddArray(MakeArray<vtkDoubleArray>(name, 1, 3, [&](vtkIdType, int k) { return v[k]; }));
  };
  const auto addFlag = [field](const char * name, bool flag) {
    field->AddArray(MakeArray<vtkIntArray>(name, 1, 1, [&](vtkIdType, int) { return flag ? 1 : 0; }));
  };
  field->AddArray(MakeArray<vtkDoubleArray>(
    "SliceOrigin", static_cast<vtkIdType>(slices.size()), 3, [&](vtkIdType i, int k) { return slices[i].origin[k]; }));
  addVector("SliceNormal", stack->GetNormal());
  addVector("SliceU", stack->GetU());
  addFlag("OpenStart", stack->GetOpenStart());
  addFlag("OpenEnd", stack->GetOpenEnd());
}

vtkSmartPointer<vtkPolyData>
ToPolyData(const ContourStack * stack)
{
  struct Row
  {
    const Contour * contour;
    int             slice;
  };
  std::vector<Row>     rows;
  std::vector<Vector3> points;
  std::vector<double>  clearance; // 0 on a contour
  std::vector<int>     offsets{ 0 };
  bool                 anyClearance = false;
  for (std::size_t k = 0; k < stack->GetSlices().size(); ++k)
  {
    for (const Contour & contour : stack->GetSlices()[k].contours)
    {
      rows.push_back({ &contour, static_cast<int>(k) });
      points.insert(points.end(), contour.points.begin(), contour.points.end());
      if (contour.points.size() == 1)
      {
        points.push_back(contour.points.front()); // VTK knows no line of one point
      }
      clearance.insert(clearance.end(), contour.clearance.begin(), contour.clearance.end());
      clearance.resize(points.size(), contour.clearance.empty() ? 0.0 : contour.clearance.back());
      anyClearance = anyClearance || !contour.clearance.empty();
      offsets.push_back(static_cast<int>(points.size()));
    }
  }
  const auto np = static_cast<vtkIdType>(points.size()), nc = static_cast<vtkIdType>(rows.size());
  auto       data = vtkSmartPointer<vtkPolyData>::New();
  auto       vtkpoints = vtkSmartPointer<vtkPoints>::New();
  vtkpoints->SetData(MakeArray<vtkDoubleArray>("Points", np, 3, [&](vtkIdType p, int k) { return points[p][k]; }));
  data->SetPoints(vtkpoints);
  if (anyClearance)
  {
    data->GetPointData()->AddArray(
      MakeArray<vtkDoubleArray>("Clearance", np, 1, [&](vtkIdType p, int) { return clearance[p]; }));
  }
  auto lines = vtkSmartPointer<vtkCellArray>::New();
  lines->SetData(MakeArray<vtkTypeInt64Array>("offsets", nc + 1, 1, [&](vtkIdType c, int) { return offsets[c]; }),
                 MakeArray<vtkTypeInt64Array>("connectivity", np, 1, [](vtkIdType p, int) { return p; }));
  data->SetLines(lines);
  const auto add = [&](const char * name, auto && value) {
    data->GetCellData()->AddArray(
      MakeArray<vtkIntArray>(name, nc, 1, [&](vtkIdType c, int) { return value(rows[c]); }));
  };
  add("Slice", [](const Row & row) { return row.slice; });
  add("Layer", [](const Row & row) { return row.contour->layer; });
  add("Contour", [](const Row & row) { return row.contour->id; });
  add("Region", [](const Row & row) { return row.contour->region; });
  add("Axis", [](const Row & row) { return row.contour->axis ? 1 : 0; });
  AddField(data, stack);
  return data;
}
} // namespace

namespace
{
ContourStack::Pointer
ReadStack(const std::string & path, const ContourSelection & selection)
{
  if (HasExtension(path, ".vtp"))
  {
    return ToContourStack(ReadVtpFile(path));
  }
  if (HasExtension(path, ".mrk.json"))
  {
    return StackPolylines(ReadMarkups(path), Vector3::Zero(), Vector3::Zero());
  }
  if (HasExtension(path, ".dcm") || IsDicomFile(path))
  {
    return StackPolylines(ReadStructure(path, selection.structure), Vector3::Zero(), Vector3::Zero());
  }
  return TraceLabels(ReadLabels(path), selection.label, selection.axis);
}
} // namespace

ContourStack::Pointer
ReadContours(const std::string & path, const ContourSelection & selection)
{
  RequireReadableFile(path);
  return NamingFile(path, [&] {
    auto stack = ReadStack(path, selection);
    stack->Verify();
    return stack;
  });
}

void
WriteContours(const ContourStack * stack, const std::string & path)
{
  RequireExtension(path, { ".vtp", ".mrk.json" });
  if (HasExtension(path, ".mrk.json"))
  {
    WriteFileAtomically(path, ToMarkups(*stack));
    return;
  }
  AtomicFile file(path);
  WriteVtpFile(ToPolyData(stack), file);
  file.Commit();
}
} // namespace bone
