/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegisteredSubjects_h
#define boneRegisteredSubjects_h

#include "boneModelIO.h"
#include "bonePopulation.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <map>
#include <string>

namespace bone
{
/** How subjects are brought onto a standard model: options of every command that does so. */
struct SubjectRegistrationOptions
{
  int                         degree{ 2 };
  AtlasRegistrationParameters parameters;

  void
  AddTo(CLI::App * command);
};

/** The meshes (.vtu) of a folder, by name; a subject's name is its file's, without extension and without four digits or
 * more and '_' before it. Throws IOError where there are none. */
FileTrainingSet::Pointer
ListRegistered(const std::string & folder);

/** The standard model of a file: a mesh (.vtu), or an atlas' mean (.h5). Throws IOError, UsageError for others. */
DensityMesh<double>::Pointer
ReadStandard(const std::string & path);

/** PopulationRegistration::Bring(); errors name the subject's shape. */
MeshArrays
BringSubject(PopulationRegistration & population, const SubjectFiles & subject);

/** A line on the last subject that was brought. */
std::string
DescribeRegistration(const SubjectFiles & subject, PopulationRegistration & population);

/** A subject's file of that number, from 0, in a folder: 0001_NAME.vtu. */
std::string
RegisteredName(std::size_t number, const SubjectFiles & subject);

/** \class RegistrationRecord
 * \brief What the meshes of a folder were registered from, so that a run that was ended goes on where it stood.
 *
 * A line of JSON each in the folder's requests.jsonl. A request is that of DescribeRequest(); null ones, by which a
 * repetition cannot be known, are not noted. */
class RegistrationRecord
{
public:
  /** Reads what there is. The folder need not exist yet. */
  explicit RegistrationRecord(const std::string & folder);

  /** Whether the file is there and whole, and was made of this request. */
  bool
  Holds(const std::string & file, const nlohmann::json & request) const;

  /** Of a file that is in the folder. Throws as RefuseToWrite(). */
  void
  Note(const std::string & file, const nlohmann::json & request);

private:
  std::string                           m_Folder;
  std::map<std::string, nlohmann::json> m_Requests;
};
} // namespace bone

#endif
