/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// Not VTK's reader: version 9.1 reads and writes beyond its buffers where a file is cut short or its numbers are wrong.
#include "boneImageHeader.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <sstream>

namespace bone
{
namespace
{
enum class PlyType
{
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Float32,
  Float64
};

struct PlyProperty
{
  std::string name;
  PlyType     type{ PlyType::Float32 };
  bool        list{ false };
  PlyType     countType{ PlyType::UInt8 };
};

struct PlyElement
{
  std::string              name;
  std::size_t              count{ 0 };
  std::vector<PlyProperty> properties;
};

PlyType
ParseType(const std::string & name)
{
  static const std::map<std::string, PlyType> types = {
    { "char", PlyType::Int8 },      { "int8", PlyType::Int8 },       { "uchar", PlyType::UInt8 },
    { "uint8", PlyType::UInt8 },    { "short", PlyType::Int16 },     { "int16", PlyType::Int16 },
    { "ushort", PlyType::UInt16 },  { "uint16", PlyType::UInt16 },   { "int", PlyType::Int32 },
    { "int32", PlyType::Int32 },    { "uint", PlyType::UInt32 },     { "uint32", PlyType::UInt32 },
    { "float", PlyType::Float32 },  { "float32", PlyType::Float32 }, { "double", PlyType::Float64 },
    { "float64", PlyType::Float64 }
  };
  const auto found = types.find(name);
  if (found == types.end())
  {
    Refuse("its header has the type '", name, "', which is none of PLY's");
  }
  return found->second;
}

/** The numbers after the header, one after another, whatever their form. */
class PlyBody
{
public:
  enum class Form
  {
    Ascii,
    Little,
    Big
  };

  PlyBody(std::string bytes, Form form)
    : m_Bytes(std::move(bytes))
    , m_Form(form)
  {}

  double
  Next(PlyType type)
  {
    if (m_Form == Form::Ascii)
    {
      return this->NextWord();
    }
    switch (type)
    {
      case PlyType::Int8:
        return this->NextBytes<std::int8_t>();
      case PlyType::UInt8:
        return this->NextBytes<std::uint8_t>();
      case PlyType::Int16:
        return this->NextBytes<std::int16_t>();
      case PlyType::UInt16:
        return this->NextBytes<std::uint16_t>();
      case PlyType::Int32:
        return this->NextBytes<std::int32_t>();
      case PlyType::UInt32:
        return this->NextBytes<std::uint32_t>();
      case PlyType::Float32:
        return this->NextBytes<float>();
      default:
        return this->NextBytes<double>();
    }
  }

  /** A number of things that the rest of the file could hold. */
  std::size_t
  NextCount(PlyType type)
  {
    const double count = this->Next(type);
    if (!(count >= 0.0 && count <= static_cast<double>(m_Bytes.size() - m_At)) || count != std::floor(count))
    {
      Refuse("is damaged: a list has ", count, " numbers");
    }
    return static_cast<std::size_t>(count);
  }

private:
  double
  NextWord()
  {
    char *       end = nullptr;
    const char * start = m_Bytes.c_str() + m_At;
    const double value = std::strtod(start, &end);
    if (end == start)
    {
      Refuse("is cut short or damaged: a number is missing after ", m_Bytes.size(), " bytes");
    }
    m_At = static_cast<std::size_t>(end - m_Bytes.c_str());
    return value;
  }

  template <typename T>
  double
  NextBytes()
  {
    if (m_Bytes.size() - m_At < sizeof(T))
    {
      Refuse("is cut short: its numbers are not all there");
    }
    const auto value = Decode<T>(&m_Bytes[m_At], m_Form == Form::Big);
    m_At += sizeof(T);
    return static_cast<double>(value);
  }

  std::string m_Bytes;
  Form        m_Form;
  std::size_t m_At{ 0 };
};

/** Reads the header's lines up to its end. */
std::vector<PlyElement>
ReadHeader(std::istream & stream, PlyBody::Form & form)
{
  constexpr int           most = 10000;
  std::vector<PlyElement> elements;
  std::string             line;
  for (int lines = 0; std::getline(stream, line) && lines < most; ++lines)
  {
    std::istringstream words(line);
    std::string        word;
    words >> word;
    if (word == "end_header")
    {
      return elements;
    }
    if (word == "format")
    {
      words >> word;
      form = word == "binary_little_endian" ? PlyBody::Form::Little
             : word == "binary_big_endian"  ? PlyBody::Form::Big
                                            : PlyBody::Form::Ascii;
    }
    else if (word == "element")
    {
      PlyElement element;
      if (!(words >> element.name >> element.count))
      {
        Refuse("its header has an element without a name and a count");
      }
      elements.push_back(element);
    }
    else if (word == "property" && !elements.empty())
    {
      PlyProperty property;
      words >> word;
      property.list = word == "list";
      if (property.list)
      {
        words >> word;
        property.countType = ParseType(word);
        words >> word;
      }
      property.type = ParseType(word);
      words >> property.name;
      elements.back().properties.push_back(property);
    }
  }
  Refuse("is no PLY file, or its header has no end");
}

/** Gives `take` each number of one element: its property, its place in a list, and the number. */
void
ReadElement(PlyBody &                                                             body,
            const PlyElement &                                                    element,
            const std::function<void(const PlyProperty &, std::size_t, double)> & take)
{
  for (const PlyProperty & property : element.properties)
  {
    const std::size_t count = property.list ? body.NextCount(property.countType) : 1;
    for (std::size_t i = 0; i < count; ++i)
    {
      take(property, i, body.Next(property.type));
    }
  }
}

void
ReadVertices(PlyBody & body, const PlyElement & element, vtkPoints * points)
{
  for (std::size_t i = 0; i < element.count; ++i)
  {
    double point[3] = { NAN, NAN, NAN };
    ReadElement(body, element, [&point](const PlyProperty & property, std::size_t, double value) {
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
      {
        point[property.name[0] - 'x'] = value;
      }
    });
    points->InsertNextPoint(point);
  }
}

void
ReadFaces(PlyBody & body, const PlyElement & element, vtkCellArray * faces)
{
  for (std::size_t i = 0; i < element.count; ++i)
  {
    std::vector<vtkIdType> face;
    ReadElement(body, element, [&face](const PlyProperty & property, std::size_t, double value) {
      if (property.list && property.name.rfind("vertex_ind", 0) == 0) // vertex_indices, vertex_index
      {
        const bool whole = value == std::floor(value) && std::abs(value) <= std::numeric_limits<int>::max();
        face.push_back(whole ? static_cast<vtkIdType>(value) : -1);
      }
    });
    if (face.size() < 3)
    {
      Refuse("face ", i, " has ", face.size(), " points");
    }
    faces->InsertNextCell(static_cast<vtkIdType>(face.size()), face.data());
  }
}
} // namespace

vtkSmartPointer<vtkPolyData>
ReadPlyFile(const std::string & path)
{
  std::ifstream stream(path, std::ios::binary);
  std::string   magic;
  std::getline(stream, magic);
  if (Trim(magic) != "ply")
  {
    Refuse("is no PLY file");
  }
  PlyBody::Form     form = PlyBody::Form::Ascii;
  const auto        elements = ReadHeader(stream, form);
  const std::string rest{ std::istreambuf_iterator<char>(stream), {} };
  PlyBody           body(rest, form);

  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> faces;
  for (const PlyElement & element : elements)
  {
    if (element.count > rest.size())
    {
      Refuse("is cut short or damaged: its header has ", element.count, " elements '", element.name, "'");
    }
    if (element.name == "vertex")
    {
      ReadVertices(body, element, points);
    }
    else if (element.name == "face")
    {
      ReadFaces(body, element, faces);
    }
    else
    {
      for (std::size_t i = 0; i < element.count; ++i)
      {
        ReadElement(body, element, [](const PlyProperty &, std::size_t, double) {});
      }
    }
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(faces);
  return data;
}
} // namespace bone
