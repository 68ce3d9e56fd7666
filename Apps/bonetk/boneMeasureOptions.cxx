/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeasureOptions.h"

#include "boneFileName.h"
#include "boneHierarchyIO.h"
#include "boneMeshIO.h"
#include "boneOptions.h"

#include <cstdio>
#include <sstream>

namespace bone
{
MeshArrays
ReadFirstLevel(const std::string & path)
{
  return HasExtension(path, ".vtu") ? ReadMeshArrays(path) : ReadHierarchy(path)->GetLevels().front().mesh->GetArrays();
}

void
RequireNumbersEach(const char * option, const std::vector<double> & numbers, std::size_t each)
{
  if (numbers.size() % each != 0)
  {
    throw UsageError(std::string(option) + " needs " + std::to_string(each) + " numbers each time, but " +
                     std::to_string(numbers.size()) + " were given");
  }
}

void
PrintMeasures(const MeasureReport & report, Session & session)
{
  std::ostringstream text;
  for (const Measure & measure : report.list.measures)
  {
    text << measure.name << ':' << (measure.text.empty() ? "" : " ") << measure.text;
    for (const double value : measure.value)
    {
      char number[40];
      std::snprintf(number, sizeof(number), " %.6g", value);
      text << number;
    }
    text << (measure.unit.empty() ? "" : " ") << measure.unit << '\n';
  }
  for (const MissingMeasure & missing : report.list.missing)
  {
    text << missing.name << ": not measured: " << missing.reason << '\n';
  }
  session.Print(text.str());
}
} // namespace bone
