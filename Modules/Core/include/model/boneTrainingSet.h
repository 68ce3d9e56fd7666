/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTrainingSet_h
#define boneTrainingSet_h

#include "boneDensityMesh.h"

#include <itkDataObject.h>
#include <itkObjectFactory.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace bone
{
/** \class TrainingSet
 * \brief Subjects on one topology, each given out when asked for, so that thousands need not be in memory at once.
 *
 * Asked for a subject several times, a set gives the same mesh. */
class TrainingSet : public itk::DataObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(TrainingSet);
  using Self = TrainingSet;
  using Superclass = itk::DataObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(TrainingSet, itk::DataObject);

  virtual std::size_t
  GetNumberOfSubjects() const = 0;
  virtual std::string
  GetSubjectName(std::size_t subject) const = 0;
  virtual MeshArrays
  GetSubject(std::size_t subject) const = 0;

protected:
  TrainingSet() = default;
  ~TrainingSet() override = default;
};

/** \class MeshTrainingSet
 * \brief A training set of meshes in memory, newer where one of them was changed. */
template <typename TMesh = DensityMesh<double>>
class MeshTrainingSet : public TrainingSet
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(MeshTrainingSet);
  using Self = MeshTrainingSet;
  using Superclass = TrainingSet;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(MeshTrainingSet, TrainingSet);

  void
  AddSubject(const std::string & name, const TMesh * mesh)
  {
    m_Subjects.emplace_back(name, mesh);
    this->Modified();
  }
  itk::ModifiedTimeType
  GetMTime() const override
  {
    itk::ModifiedTimeType time = Superclass::GetMTime();
    for (const auto & subject : m_Subjects)
    {
      time = std::max(time, subject.second->GetMTime());
    }
    return time;
  }
  std::size_t
  GetNumberOfSubjects() const override
  {
    return m_Subjects.size();
  }
  std::string
  GetSubjectName(std::size_t subject) const override
  {
    return m_Subjects.at(subject).first;
  }
  MeshArrays
  GetSubject(std::size_t subject) const override
  {
    return m_Subjects.at(subject).second->GetArrays();
  }

protected:
  MeshTrainingSet() = default;
  ~MeshTrainingSet() override = default;

private:
  std::vector<std::pair<std::string, typename TMesh::ConstPointer>> m_Subjects;
};
} // namespace bone

#endif
