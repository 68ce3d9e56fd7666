/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementIO.h"

#include "boneAtomicFile.h"
#include "boneFileName.h"
#include "boneFiniteElementText.h"
#include "boneIOError.h"
#include "boneMeshIO.h"

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <stdexcept>

namespace bone
{
namespace
{
template <typename TArray, typename TValues>
void
AddArray(vtkDataSetAttributes * data, const char * name, const TValues & values)
{
  auto array = vtkSmartPointer<TArray>::New();
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    array->SetValue(static_cast<vtkIdType>(i), values[i]);
  }
  data->AddArray(array);
}

/** 1 in the set, 0 elsewhere. */
void
AddSetArrays(vtkDataSetAttributes * data, const std::vector<FiniteElementSet> & sets, std::size_t count)
{
  for (const FiniteElementSet & set : sets)
  {
    std::vector<unsigned char> member(count, 0);
    for (const IdType id : set.ids)
    {
      member[static_cast<std::size_t>(id)] = 1;
    }
    AddArray<vtkUnsignedCharArray>(data, set.name.c_str(), member);
  }
}

vtkSmartPointer<vtkUnstructuredGrid>
FiniteElementGrid(const FiniteElementModel & model)
{
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  for (const Vector3 & x : model.nodes)
  {
    points->InsertNextPoint(x.data());
  }
  grid->SetPoints(points);
  grid->Allocate(static_cast<vtkIdType>(model.elements.size()));
  for (const auto & element : model.elements)
  {
    std::array<vtkIdType, 10> ids{};
    std::copy(element.begin(), element.end(), ids.begin());
    grid->InsertNextCell(model.order == 2 ? VTK_QUADRATIC_TETRA : VTK_TETRA, model.NodesEach(), ids.data());
  }
  std::vector<int>    material;
  std::vector<double> binned;
  for (const int m : model.material)
  {
    material.push_back(m + 1);
    binned.push_back(model.materials[static_cast<std::size_t>(m)].modulus);
  }
  AddArray<vtkDoubleArray>(grid->GetCellData(), "YoungsModulus", model.modulus);
  grid->GetCellData()->SetActiveScalars("YoungsModulus");
  AddArray<vtkDoubleArray>(grid->GetCellData(), "BinnedModulus", binned);
  AddArray<vtkDoubleArray>(grid->GetCellData(), "MassDensity", model.massDensity);
  AddArray<vtkIntArray>(grid->GetCellData(), "Region", model.region);
  AddArray<vtkIntArray>(grid->GetCellData(), "Material", material);
  AddArray<vtkDoubleArray>(grid->GetPointData(), "YoungsModulus", model.nodeModulus);
  AddSetArrays(grid->GetPointData(), model.nodeSets, model.nodes.size());
  return grid;
}
} // namespace

void
FiniteElementText::AddDescription(const FiniteElementModel & model, const std::string & mark, const std::string & end)
{
  *this << mark << "BoneTK: mm, N, MPa, t/mm^3" << end << mark << "Young's modulus by " << model.law.name << ": "
        << model.law.DescribeRelation() << " MPa of " << DensityQuantityName(model.law.density) << end << mark << "for "
        << model.law.low << " to " << model.law.high << " g/cm^3, " << model.law.bone << "; " << model.law.source << end
        << mark << "Poisson's ratio " << model.parameters.poissonRatio << ", at least " << model.parameters.leastModulus
        << " MPa" << end;
}

const char *
FiniteElementExtension(FiniteElementFormat format)
{
  constexpr std::array<const char *, 5> extensions = { ".inp", ".inp", ".feb", ".msh", ".vtu" };
  return extensions[static_cast<std::size_t>(format)];
}

bool
HoldsModulusField(FiniteElementFormat format, ModulusField field)
{
  const bool carriesAll = format == FiniteElementFormat::Gmsh || format == FiniteElementFormat::VTK;
  const auto other = format == FiniteElementFormat::FEBio ? ModulusField::Cells : ModulusField::Nodes;
  return carriesAll || field == ModulusField::Bins || field == other;
}

void
WriteFiniteElements(const FiniteElementModel & model, FiniteElementFormat format, const std::string & path)
{
  const char * extension = FiniteElementExtension(format);
  if (!HasExtension(path, extension))
  {
    throw IOError(path, std::string("must end in ") + extension);
  }
  if (!HoldsModulusField(format, model.parameters.modulusField))
  {
    throw std::invalid_argument(
      std::string("A file for ") + ParameterChoices<FiniteElementFormat>::names[static_cast<std::size_t>(format)] +
      " cannot hold moduli by " +
      ParameterChoices<ModulusField>::names[static_cast<std::size_t>(model.parameters.modulusField)] +
      ": take bins, or " + (format == FiniteElementFormat::FEBio ? "cells." : "nodes."));
  }
  switch (format)
  {
    case FiniteElementFormat::Abaqus:
    case FiniteElementFormat::CalculiX:
      return WriteFileAtomically(path, AbaqusText(model));
    case FiniteElementFormat::FEBio:
      return WriteFileAtomically(path, FEBioText(model));
    case FiniteElementFormat::Gmsh:
      return WriteFileAtomically(path, GmshText(model));
    case FiniteElementFormat::VTK:
      return WriteUnstructuredGrid(FiniteElementGrid(model), path);
  }
}
} // namespace bone
