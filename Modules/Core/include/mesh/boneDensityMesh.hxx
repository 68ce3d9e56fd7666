/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityMesh_hxx
#define boneDensityMesh_hxx

#include "boneBernstein.h"
#include "boneDensityMesh.h"

namespace bone
{
template <typename TCoordinate>
void
DensityMesh<TCoordinate>::SetArrays(MeshArrays arrays)
{
  const std::size_t np = arrays.points.size(), nt = arrays.tetrahedra.size();
  for (std::size_t t = 0; t < nt; ++t)
  {
    for (IdType v : arrays.tetrahedra[t])
    {
      if (v < 0 || static_cast<std::size_t>(v) >= np)
      {
        itkExceptionMacro("Tetrahedron " << t << " names point " << v << ", but there are " << np << " points.");
      }
    }
  }
  const auto check = [&](std::size_t size, std::size_t expected, const char * name) {
    if (size != 0 && size != expected)
    {
      itkExceptionMacro("The array '" << name << "' has " << size << " entries where " << expected << " are needed.");
    }
  };
  check(arrays.neighbors.size(), nt, "neighbors");
  check(arrays.layer.size(), np, "layer");
  check(arrays.slice.size(), np, "slice");
  check(arrays.region.size(), nt, "region");
  check(arrays.degree.size(), nt, "degree");
  if (arrays.HasDensity())
  {
    const std::size_t expected = nt * static_cast<std::size_t>(BernsteinCount(arrays.maximumDegree));
    if (arrays.degree.size() != nt || arrays.coefficients.size() != expected)
    {
      itkExceptionMacro("A density of degree " << arrays.maximumDegree << " needs " << expected << " coefficients and "
                                               << nt << " degrees, but there are " << arrays.coefficients.size()
                                               << " and " << arrays.degree.size() << ".");
    }
  }
  if (arrays.neighbors.empty())
  {
    arrays.neighbors = ComputeFaceNeighbors(arrays.tetrahedra);
  }
  auto container = Superclass::PointsContainer::New();
  container->Reserve(np);
  for (std::size_t p = 0; p < np; ++p)
  {
    PointType & point = container->ElementAt(p);
    for (int k = 0; k < 3; ++k)
    {
      point[k] = static_cast<TCoordinate>(arrays.points[p][k]);
    }
  }
  this->SetPoints(container);
  m_Cells = std::move(static_cast<MeshCells &>(arrays));
  this->Modified();
}

template <typename TCoordinate>
MeshArrays
DensityMesh<TCoordinate>::GetArrays() const
{
  MeshArrays arrays{ m_Cells, {} };
  const auto np = this->GetNumberOfPoints();
  arrays.points.resize(np);
  if (np > 0)
  {
    const auto & points = this->GetPoints()->CastToSTLConstContainer();
    for (std::size_t p = 0; p < np; ++p)
    {
      arrays.points[p] = Vector3(points[p][0], points[p][1], points[p][2]);
    }
  }
  return arrays;
}

template <typename TCoordinate>
void
DensityMesh<TCoordinate>::Initialize()
{
  Superclass::Initialize();
  m_Cells = MeshCells();
}

template <typename TCoordinate>
void
DensityMesh<TCoordinate>::Graft(const itk::DataObject * data)
{
  const auto * mesh = dynamic_cast<const Self *>(data);
  if (data != nullptr && mesh == nullptr)
  {
    itkExceptionMacro("Cannot graft a " << data->GetNameOfClass() << " onto a DensityMesh.");
  }
  Superclass::Graft(data);
  if (mesh != nullptr)
  {
    m_Cells = mesh->m_Cells;
  }
}

template <typename TCoordinate>
void
DensityMesh<TCoordinate>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Tetrahedra: " << m_Cells.tetrahedra.size() << '\n';
  os << indent << "MaximumDegree: " << m_Cells.maximumDegree << '\n';
  os << indent << "DensityQuantity: " << DensityQuantityName(m_Cells.quantity) << '\n';
}
} // namespace bone

#endif
