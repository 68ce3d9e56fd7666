/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneModelIO_h
#define boneModelIO_h

#include "boneStatisticalModel.h"
#include "boneTrainingSet.h"

#include <string>
#include <utility>
#include <vector>

namespace bone
{
/** \defgroup ModelIO Statistical models in HDF5 (.h5)
 *
 * /representer, /model and /version follow the statismo 0.9 layout (shape in single precision, a volume mesh), so that
 * its readers and scalismo's take the shape part. /bonetk holds the whole model in double; it is what is read here:
 * tetrahedra (#t by 4), region, layer, slice; shape and density, each with mean (#d), modes (#k by #d), variances (#k),
 * scores (#subjects by #k) and weights (#d, where there are any); combined with vectors (#k by #ks + #kd), variances;
 * subjects (names); attributes degree, quantity, similarity, version. All functions throw IOError.
 * \{ */

/** Writes the whole file or none. */
void
WriteStatisticalModel(const StatisticalModel * model, const std::string & path);

/** Refuses what is missing, broken, of another version, or does not match in itself. */
StatisticalModel::Pointer
ReadStatisticalModel(const std::string & path);

/** Writes matrices by name, datasets of rows x columns, into an HDF5 file; the whole file or none. */
void
WriteMatrices(const std::vector<std::pair<std::string, Eigen::MatrixXd>> & matrices, const std::string & path);
/** \} */

/** \class FileTrainingSet
 * \brief Subjects in .vtu files, each read when it is asked for. */
class FileTrainingSet : public TrainingSet
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(FileTrainingSet);
  using Self = FileTrainingSet;
  using Superclass = TrainingSet;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(FileTrainingSet, TrainingSet);

  void
  AddSubject(const std::string & name, const std::string & path);
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
  GetSubject(std::size_t subject) const override;

protected:
  FileTrainingSet() = default;
  ~FileTrainingSet() override = default;

private:
  std::vector<std::pair<std::string, std::string>> m_Subjects; // name and path
};
} // namespace bone

#endif
