/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTestStructures_h
#define boneTestStructures_h

#include "boneTypes.h"

#include <gdcmAttribute.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmUIDGenerator.h>
#include <gdcmWriter.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace bone
{
/** A structure of a DICOM structure set. */
struct Structure
{
  std::string                       name;
  std::vector<std::vector<Vector3>> contours;
  std::string                       type{ "CLOSED_PLANAR " };
};

template <uint16_t VGroup, uint16_t VElement, typename TValue>
void
PutAttribute(gdcm::DataSet & data, const TValue & value)
{
  gdcm::Attribute<VGroup, VElement> attribute{};
  attribute.SetValue(value);
  data.Replace(attribute.GetAsDataElement());
}

inline gdcm::SmartPointer<gdcm::SequenceOfItems>
NewSequence()
{
  gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
  sequence->SetLengthToUndefined();
  return sequence;
}

inline void
AddItem(gdcm::SequenceOfItems * sequence, const gdcm::DataSet & data)
{
  gdcm::Item item;
  item.SetVLToUndefined();
  item.SetNestedDataSet(data);
  sequence->AddItem(item);
}

inline void
PutSequence(gdcm::DataSet & data, const gdcm::Tag & tag, gdcm::SequenceOfItems * sequence)
{
  gdcm::DataElement element(tag);
  element.SetVR(gdcm::VR::SQ);
  element.SetValue(*sequence);
  element.SetVLToUndefined();
  data.Replace(element);
}

inline gdcm::DataSet
ContourItem(const Structure & structure, const std::vector<Vector3> & points)
{
  gdcm::DataSet data;
  PutAttribute<0x3006, 0x0042>(data, gdcm::CSComp(structure.type));
  PutAttribute<0x3006, 0x0046>(data, static_cast<int>(points.size()));
  std::vector<double> values;
  for (const Vector3 & p : points)
  {
    values.insert(values.end(), p.data(), p.data() + 3);
  }
  gdcm::Attribute<0x3006, 0x0050> attribute;
  attribute.SetValues(values.data(), static_cast<unsigned int>(values.size()), true);
  data.Replace(attribute.GetAsDataElement());
  return data;
}

/** Writes a DICOM structure set, or what calls itself of another modality. */
inline void
WriteStructures(const std::string & path, const std::vector<Structure> & structures, const std::string & modality)
{
  gdcm::Writer       writer;
  gdcm::DataSet &    data = writer.GetFile().GetDataSet();
  gdcm::UIDGenerator uids;
  PutAttribute<0x0008, 0x0016>(data, gdcm::UIComp("1.2.840.10008.5.1.4.1.1.481.3"));
  PutAttribute<0x0008, 0x0018>(data, gdcm::UIComp(uids.Generate()));
  PutAttribute<0x0008, 0x0060>(data, gdcm::CSComp(modality));
  const auto names = NewSequence();
  const auto contours = NewSequence();
  for (std::size_t s = 0; s < structures.size(); ++s)
  {
    const int     number = static_cast<int>(10 * s + 3);
    gdcm::DataSet name;
    PutAttribute<0x3006, 0x0022>(name, number);
    PutAttribute<0x3006, 0x0026>(name, gdcm::LOComp(structures[s].name));
    AddItem(names, name);
    gdcm::DataSet content;
    PutAttribute<0x3006, 0x0084>(content, number);
    const auto sequence = NewSequence();
    for (const auto & points : structures[s].contours)
    {
      AddItem(sequence, ContourItem(structures[s], points));
    }
    PutSequence(content, gdcm::Tag(0x3006, 0x0040), sequence);
    AddItem(contours, content);
  }
  PutSequence(data, gdcm::Tag(0x3006, 0x0020), names);
  PutSequence(data, gdcm::Tag(0x3006, 0x0039), contours);
  writer.GetFile().GetHeader().SetDataSetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
  writer.SetFileName(path.c_str());
  if (!writer.Write())
  {
    throw std::runtime_error("cannot write " + path);
  }
}
} // namespace bone

#endif
