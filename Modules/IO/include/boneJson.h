/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneJson_h
#define boneJson_h

#include "boneTypes.h"

#include <nlohmann/json.hpp>

#include <initializer_list>
#include <string>

namespace bone
{
/** The JSON document in a file. Throws IOError where there is none, or it is nested more than a hundred levels deep. */
nlohmann::json
ReadJsonFile(const std::string & path);

/** A member that must be there. Throws itk::ExceptionObject naming it. */
const nlohmann::json &
Member(const nlohmann::json & object, const char * name);

/** Members as types; throw itk::ExceptionObject naming the member where it is missing or something else. */
double
NumberMember(const nlohmann::json & object, const char * name);
long long
WholeMember(const nlohmann::json & object, const char * name, long long lowest, long long highest);
std::string
TextMember(const nlohmann::json & object, const char * name);
/** The name of a file, which is not empty. */
std::string
FileMember(const nlohmann::json & object, const char * name);
Eigen::VectorXd
NumbersMember(const nlohmann::json & object, const char * name, int count);

/** Throws itk::ExceptionObject where the value is no object or has a member that is not among the names. */
void
RequireMembersAmong(const nlohmann::json & object, std::initializer_list<const char *> names);

template <typename TVector>
nlohmann::json
ToJson(const TVector & vector)
{
  return nlohmann::json(std::vector<typename TVector::Scalar>(vector.data(), vector.data() + vector.size()));
}
} // namespace bone

#endif
