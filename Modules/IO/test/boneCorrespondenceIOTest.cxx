/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorrespondenceIO.h"

#include "boneTestFiles.h"

namespace bone
{
namespace CorrespondenceIOTests
{
using testing::HasSubstr;
using CorrespondenceIOTest = FileTest;

TEST_F(CorrespondenceIOTest, IsReadAsWritten)
{
  ContourCorrespondence correspondence;
  correspondence.slabs[0] = { { { 0, 3 }, { 1 } }, { { 2 }, {} } };
  correspondence.slabs[7] = {};
  WriteCorrespondence(correspondence, Path("c.json"));
  EXPECT_EQ(ReadCorrespondence(Path("c.json")).slabs, correspondence.slabs);
}

TEST_F(CorrespondenceIOTest, SaysWhatIsWrong)
{
  const auto message = [this](const std::string & text) {
    WriteText("c.json", text);
    try
    {
      ReadCorrespondence(Path("c.json"));
    }
    catch (const IOError & error)
    {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_THAT(message("{}"), HasSubstr("'slabs'"));
  EXPECT_THAT(message(R"({"slabs": 3})"), HasSubstr("must be a list"));
  EXPECT_THAT(message(R"({"slabs": [{"slice": -1, "groups": []}]})"), HasSubstr("'slice'"));
  EXPECT_THAT(message(R"({"slabs": [{"slice": 1, "groups": []}, {"slice": 1, "groups": []}]})"),
              HasSubstr("slice 1 is there twice"));
  EXPECT_THAT(message(R"({"slabs": [{"slice": 1, "groups": [{"lower": [0.5], "upper": []}]}]})"),
              HasSubstr("whole numbers"));
  EXPECT_THAT(message(R"({"slabs": [{"slice": 1, "groups": [{"lower": []}]}]})"), HasSubstr("'upper'"));
}
} // namespace CorrespondenceIOTests
} // namespace bone
