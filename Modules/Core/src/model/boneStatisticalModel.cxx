/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStatisticalModel.h"

namespace bone
{
namespace
{
bool
Consistent(const PrincipalModes & modes)
{
  return modes.modes.rows() == modes.mean.size() && modes.modes.cols() == modes.variances.size() &&
         (modes.weights.size() == 0 || modes.weights.size() == modes.mean.size()) &&
         (modes.block.size() == 0 ||
          (modes.block.rows() == modes.block.cols() && modes.mean.size() % modes.block.rows() == 0));
}
} // namespace

Eigen::VectorXd
StackPoints(const std::vector<Vector3> & points)
{
  Eigen::VectorXd stacked(3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    stacked.segment<3>(3 * static_cast<Eigen::Index>(p)) = points[p];
  }
  return stacked;
}

std::vector<Vector3>
UnstackPoints(const Eigen::VectorXd & stacked)
{
  std::vector<Vector3> points(static_cast<std::size_t>(stacked.size() / 3));
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    points[p] = stacked.segment<3>(3 * static_cast<Eigen::Index>(p));
  }
  return points;
}

void
StatisticalModel::SetContent(StatisticalModelContent content)
{
  const auto points = static_cast<Eigen::Index>(content.mean.points.size());
  const auto coefficients = static_cast<Eigen::Index>(content.mean.coefficients.size());
  if (content.shape.GetDimension() != 3 * points || !Consistent(content.shape))
  {
    itkExceptionMacro("The shape modes do not match the mean mesh: " << content.shape.GetDimension()
                                                                     << " coordinates for " << points << " points.");
  }
  if (content.density.GetDimension() > 0 &&
      (content.density.GetDimension() != coefficients || !Consistent(content.density)))
  {
    itkExceptionMacro("The density modes do not match the mean mesh: "
                      << content.density.GetDimension() << " coefficients where the mesh has " << coefficients << '.');
  }
  const Eigen::Index together = content.shape.GetNumberOfModes() + content.density.GetNumberOfModes();
  if (content.combined.variances.size() > 0 &&
      (content.combined.vectors.rows() != together ||
       content.combined.vectors.cols() != content.combined.variances.size() || !(content.combined.shapeWeight > 0)))
  {
    itkExceptionMacro("The combined modes do not match the " << together << " modes of shape and density.");
  }
  m_Content = std::move(content);
  this->Modified();
}

MeshArrays
StatisticalModel::Synthesize(const Eigen::VectorXd & shape, const Eigen::VectorXd & density) const
{
  if (shape.size() > m_Content.shape.GetNumberOfModes() || density.size() > m_Content.density.GetNumberOfModes())
  {
    itkExceptionMacro("" << shape.size() << " shape and " << density.size()
                         << " density coefficients are too many: there are " << m_Content.shape.GetNumberOfModes()
                         << " shape and " << m_Content.density.GetNumberOfModes() << " density modes.");
  }
  MeshArrays mesh = m_Content.mean;
  mesh.points = UnstackPoints(m_Content.shape.Synthesize(shape));
  if (this->HasDensity())
  {
    const Eigen::VectorXd coefficients = m_Content.density.Synthesize(density);
    mesh.coefficients.assign(coefficients.data(), coefficients.data() + coefficients.size());
  }
  return mesh;
}

void
StatisticalModel::SplitCombined(const Eigen::VectorXd & combined,
                                Eigen::VectorXd &       shape,
                                Eigen::VectorXd &       density) const
{
  const CombinedModes & c = m_Content.combined;
  if (combined.size() > c.variances.size())
  {
    itkExceptionMacro("" << combined.size() << " combined coefficients are too many: there are " << c.variances.size()
                         << " combined modes.");
  }
  const Eigen::Index    k = combined.size();
  const Eigen::VectorXd both = c.vectors.leftCols(k) * (c.variances.head(k).cwiseSqrt().cwiseProduct(combined));
  const Eigen::Index    ks = m_Content.shape.GetNumberOfModes();
  shape = (both.head(ks) / c.shapeWeight).cwiseQuotient(m_Content.shape.variances.cwiseSqrt());
  density = both.tail(both.size() - ks).cwiseQuotient(m_Content.density.variances.cwiseSqrt());
}

Eigen::VectorXd
StatisticalModel::JoinCombined(const Eigen::VectorXd & shape, const Eigen::VectorXd & density) const
{
  const CombinedModes & c = m_Content.combined;
  const Eigen::Index    ks = m_Content.shape.GetNumberOfModes(), kd = m_Content.density.GetNumberOfModes();
  if (!this->IsCombined() || shape.size() != ks || density.size() != kd)
  {
    itkExceptionMacro("" << shape.size() << " shape and " << density.size() << " density coefficients given; "
                         << (this->IsCombined() ? ks : 0) << " and " << (this->IsCombined() ? kd : 0)
                         << " can be joined.");
  }
  Eigen::VectorXd both(ks + kd);
  both << c.shapeWeight * m_Content.shape.variances.cwiseSqrt().cwiseProduct(shape),
    m_Content.density.variances.cwiseSqrt().cwiseProduct(density);
  return (c.vectors.transpose() * both).cwiseQuotient(c.variances.cwiseSqrt());
}

void
StatisticalModel::Initialize()
{
  Superclass::Initialize();
  m_Content = StatisticalModelContent();
}

void
StatisticalModel::Graft(const itk::DataObject * data)
{
  const auto * other = dynamic_cast<const Self *>(data);
  if (data != nullptr && other == nullptr)
  {
    itkExceptionMacro("Cannot graft a " << data->GetNameOfClass() << " onto a StatisticalModel.");
  }
  Superclass::Graft(data);
  if (other != nullptr)
  {
    m_Content = other->m_Content;
  }
}

void
StatisticalModel::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Points: " << m_Content.mean.points.size() << std::endl;
  os << indent << "Tetrahedra: " << m_Content.mean.tetrahedra.size() << std::endl;
  os << indent << "Subjects: " << m_Content.subjects.size() << std::endl;
  os << indent << "ShapeModes: " << m_Content.shape.GetNumberOfModes() << std::endl;
  os << indent << "DensityModes: " << m_Content.density.GetNumberOfModes() << std::endl;
  os << indent << "CombinedModes: " << m_Content.combined.variances.size() << std::endl;
}
} // namespace bone
