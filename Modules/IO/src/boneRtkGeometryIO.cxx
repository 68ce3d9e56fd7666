/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneGeometryIO.h"

#include "boneAtomicFile.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
constexpr const char * rootName = "RTKThreeDCircularGeometry";

struct Parameter
{
  const char * name;
  double RtkProjection::*value;
};
constexpr Parameter parameters[] = { { "SourceToIsocenterDistance", &RtkProjection::sourceToIsocenter },
                                     { "SourceToDetectorDistance", &RtkProjection::sourceToDetector },
                                     { "GantryAngle", &RtkProjection::gantryAngle },
                                     { "OutOfPlaneAngle", &RtkProjection::outOfPlaneAngle },
                                     { "InPlaneAngle", &RtkProjection::inPlaneAngle },
                                     { "SourceOffsetX", &RtkProjection::sourceOffsetX },
                                     { "SourceOffsetY", &RtkProjection::sourceOffsetY },
                                     { "ProjectionOffsetX", &RtkProjection::projectionOffsetX },
                                     { "ProjectionOffsetY", &RtkProjection::projectionOffsetY } };

/** The numbers of an element, exactly `count`. */
std::vector<double>
Numbers(vtkXMLDataElement * element, std::size_t count)
{
  const char *        text = element->GetCharacterData();
  std::istringstream  stream(text == nullptr ? "" : text);
  std::vector<double> numbers;
  for (double number; stream >> number;)
  {
    numbers.push_back(number);
  }
  if (numbers.size() != count || !stream.eof())
  {
    Refuse("'", element->GetName(), "' must hold ", count, count == 1 ? " number" : " numbers");
  }
  return numbers;
}

/** Takes what the element says of a projection; the matrix, which follows from the rest, is compared. */
void
TakeParameters(vtkXMLDataElement * element, RtkProjection & projection)
{
  for (int i = 0; i < element->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement * child = element->GetNestedElement(i);
    const std::string   name = child->GetName();
    for (const Parameter & parameter : parameters)
    {
      if (name == parameter.name)
      {
        projection.*parameter.value = Numbers(child, 1)[0];
      }
    }
    if (name == "RadiusCylindricalDetector" && Numbers(child, 1)[0] != 0)
    {
      Refuse("has a cylindrical detector; only flat ones can be used");
    }
  }
  vtkXMLDataElement * matrix = element->FindNestedElementWithName("Matrix");
  if (matrix == nullptr)
  {
    return;
  }
  const std::vector<double> numbers = Numbers(matrix, 12);
  const ProjectionMatrix    stored = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data());
  // RTK writes 15 digits.
  if (!((RtkMatrix(projection) - stored).norm() <= 1e-6 * stored.norm()))
  {
    Refuse("'Matrix' does not follow from the projection's other parameters");
  }
}

std::string
RtkText(const std::vector<RtkProjection> & projections)
{
  std::ostringstream text;
  text << std::setprecision(17) << "<?xml version=\"1.0\"?>\n<!DOCTYPE RTKGEOMETRY>\n<" << rootName
       << " version=\"3\">\n";
  for (const RtkProjection & projection : projections)
  {
    text << "  <Projection>\n";
    for (const Parameter & parameter : parameters)
    {
      text << "    <" << parameter.name << '>' << projection.*parameter.value << "</" << parameter.name << ">\n";
    }
    static const Eigen::IOFormat rows(17, Eigen::DontAlignCols, " ", "\n      ");
    text << "    <Matrix>\n      " << RtkMatrix(projection).format(rows) << "\n    </Matrix>\n  </Projection>\n";
  }
  text << "</" << rootName << ">\n";
  return text.str();
}
} // namespace

std::vector<RtkProjection>
ReadRtkGeometry(const std::string & path)
{
  return NamingFile(path, [&] {
    const auto root = ReadXmlFile(path);
    if (root == nullptr || root->GetName() != std::string(rootName))
    {
      Refuse("is no RTK geometry: <", rootName, "> is missing");
    }
    RtkProjection              common;
    std::vector<RtkProjection> projections;
    TakeParameters(root, common);
    for (int i = 0; i < root->GetNumberOfNestedElements(); ++i)
    {
      if (root->GetNestedElement(i)->GetName() == std::string("Projection"))
      {
        projections.push_back(common);
        TakeParameters(root->GetNestedElement(i), projections.back());
      }
    }
    if (projections.empty())
    {
      Refuse("holds no projection");
    }
    return projections;
  });
}

RtkGrid
WriteRtkGeometry(const std::vector<XRayGeometry::Pointer> & views, const std::string & path)
{
  RtkGrid                    grid;
  std::vector<RtkProjection> projections;
  NamingFile(path, [&] {
    for (const auto & view : views)
    {
      RtkGrid own;
      projections.emplace_back();
      ToRtk(view->GetView(), projections.back(), own);
      const RtkGrid & first = projections.size() == 1 ? own : grid;
      if (own.size != first.size || !own.spacing.isApprox(first.spacing) || own.rowsDown != first.rowsDown ||
          (projections.back().sourceToDetector == 0) != (projections.front().sourceToDetector == 0))
      {
        Refuse(
          "RTK's projections are one stack of images: the views must agree in size, spacing, handedness and kind of "
          "beam");
      }
      grid = own;
    }
  });
  WriteFileAtomically(path, RtkText(projections));
  return grid;
}
} // namespace bone
