/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtomicFile.h"
#include "boneIOError.h"
#include "boneOutputTransaction.h"
#include "boneStagingFolder.h"

#include "boneTestFiles.h"

#include <cerrno>
#include <cstring>

#include <sys/wait.h>
#include <unistd.h>

namespace bone
{
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using AtomicFileTest = FileTest;

TEST_F(AtomicFileTest, NothingStandsUnderTheNameBeforeCommit)
{
  AtomicFile file(Path("a.txt"));
  std::ofstream(file.GetTemporaryPath()) << "content";
  EXPECT_FALSE(std::filesystem::exists(Path("a.txt")));
  EXPECT_THAT(file.GetTemporaryPath(), HasSubstr("/.bonetk-tmp-"));
  EXPECT_EQ(std::filesystem::path(file.GetTemporaryPath()).filename(), "a.txt");
  file.Commit();
  EXPECT_THAT(Files(), ElementsAre("a.txt"));
  EXPECT_EQ(ReadText("a.txt"), "content");
}

TEST(RefuseToWriteTest, WhatAnotherTryMayDoIsTheMachines)
{
  for (const int code : { ENOSPC, EDQUOT, EIO, ENOMEM, EFBIG })
  {
    EXPECT_THROW(RefuseToWrite("a.txt", "cannot write", code), MachineError) << code;
  }
  for (const int code : { ENOENT, EACCES, EROFS, ENAMETOOLONG })
  {
    try
    {
      RefuseToWrite("a.txt", "cannot write", code);
    }
    catch (const IOError & error)
    {
      EXPECT_EQ(dynamic_cast<const MachineError *>(&error), nullptr);
      EXPECT_EQ(std::string(error.what()), std::string("a.txt: cannot write: ") + std::strerror(code));
    }
  }
}

TEST_F(AtomicFileTest, WithoutCommitTheFormerFileStays)
{
  WriteText("a.txt", "before");
  {
    AtomicFile file(Path("a.txt"));
    std::ofstream(file.GetTemporaryPath()) << "after";
  }
  EXPECT_EQ(ReadText("a.txt"), "before");
  EXPECT_THAT(Files(), ElementsAre("a.txt"));
}

TEST_F(AtomicFileTest, CompanionFilesComeAlong)
{
  AtomicFile file(Path("a.mhd"));
  std::ofstream(file.GetTemporaryPath()) << "header";
  std::ofstream(std::filesystem::path(file.GetTemporaryPath()).replace_extension(".raw")) << "data";
  file.Commit();
  EXPECT_THAT(Files(), ElementsAre("a.mhd", "a.raw"));
}

TEST_F(AtomicFileTest, ASymbolicLinkIsFollowedAndStays)
{
  std::filesystem::create_directory(Path("far"));
  WriteText("far/real.txt", "before");
  std::filesystem::create_symlink("far/real.txt", Path("link.txt"));
  WriteFileAtomically(Path("link.txt"), "after");
  EXPECT_TRUE(std::filesystem::is_symlink(Path("link.txt")));
  EXPECT_EQ(ReadText("far/real.txt"), "after");
}

TEST_F(AtomicFileTest, ARelativeNameIsWrittenBesideTheProcess)
{
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(m_Folder);
  WriteFileAtomically("a.txt", "content");
  std::filesystem::current_path(before);
  EXPECT_THAT(Files(), ElementsAre("a.txt"));
}

TEST_F(AtomicFileTest, RefusesWhatIsNoPlaceForAFile)
{
  EXPECT_THAT(ErrorOf([&] { AtomicFile file(Path("no/such/a.txt")); }), HasSubstr("there is no folder"));
  EXPECT_THAT(ErrorOf([&] { AtomicFile file(m_Folder.string()); }), HasSubstr("is a folder"));
  EXPECT_THAT(ErrorOf([&] { AtomicFile file(m_Folder.string() + "/"); }), HasSubstr("names no file"));
  EXPECT_THAT(ErrorOf([&] { AtomicFile file(""); }), HasSubstr("names no file"));
  EXPECT_THAT(ErrorOf([&] { AtomicFile file("/dev/full"); }), HasSubstr("is no regular file"));
  EXPECT_THAT(ErrorOf([&] { AtomicFile file("/proc/a.txt"); }), HasSubstr("cannot write into the folder"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(AtomicFileTest, AFullDiskLeavesTheFormerFile)
{
  WriteText("a.txt", "before");
  const std::string line = ErrorOf([&] {
    const FullDisk full(1000);
    WriteFileAtomically(Path("a.txt"), std::string(100000, 'x'));
  });
  EXPECT_THAT(line, HasSubstr("a.txt: cannot write"));
  EXPECT_EQ(ReadText("a.txt"), "before");
  EXPECT_THAT(Files(), ElementsAre("a.txt"));
}

TEST_F(AtomicFileTest, AReplacedFileKeepsItsMode)
{
  namespace fs = std::filesystem;
  WriteText("a.txt", "before");
  fs::permissions(Path("a.txt"), fs::perms::owner_read | fs::perms::owner_write);
  WriteFileAtomically(Path("a.txt"), "after");
  EXPECT_EQ(ReadText("a.txt"), "after");
  EXPECT_EQ(fs::status(Path("a.txt")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(AtomicFileTest, FilesOfATransactionAppearTogether)
{
  WriteText("a.txt", "before");
  OutputTransaction all;
  WriteFileAtomically(Path("a.txt"), "after");
  WriteFileAtomically(Path("b.txt"), "new");
  EXPECT_EQ(ReadText("a.txt"), "before");
  EXPECT_FALSE(std::filesystem::exists(Path("b.txt")));
  all.Commit();
  EXPECT_EQ(ReadText("a.txt"), "after");
  EXPECT_EQ(ReadText("b.txt"), "new");
  EXPECT_THAT(Files(), ElementsAre("a.txt", "b.txt"));
}

TEST_F(AtomicFileTest, ATransactionThatIsNotCommittedLeavesNothing)
{
  {
    OutputTransaction all;
    WriteFileAtomically(Path("a.txt"), "content");
    StagingFolder folder(Path("out"));
    WriteFileAtomically(folder.GetPath() + "/b.txt", "content");
    EXPECT_TRUE(std::filesystem::exists(folder.GetPath() + "/b.txt"));
    folder.Commit();
    EXPECT_THROW(OutputTransaction(), std::logic_error);
  }
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(AtomicFileTest, AMoveThatFailsPutsTheOthersBack)
{
  WriteText("a.txt", "before");
  {
    OutputTransaction all;
    WriteFileAtomically(Path("a.txt"), "after");
    WriteFileAtomically(Path("b.txt"), "new");
    WriteFileAtomically(Path("c.txt"), "new");
    std::filesystem::create_directory(Path("c.txt"));
    EXPECT_THAT(ErrorOf([&] { all.Commit(); }), HasSubstr("c.txt: cannot write"));
  }
  EXPECT_EQ(ReadText("a.txt"), "before");
  EXPECT_THAT(Files(), ElementsAre("a.txt", "c.txt"));
}

TEST_F(AtomicFileTest, TwoOutputsOfOneNameAreRefused)
{
  OutputTransaction all;
  WriteFileAtomically(Path("a.txt"), "first");
  EXPECT_THAT(ErrorOf([&] { WriteFileAtomically(Path("./a.txt"), "second"); }), HasSubstr("the name of two outputs"));
}

TEST_F(AtomicFileTest, AFolderLosesWhatIsOutOfDate)
{
  std::filesystem::create_directory(Path("out"));
  for (const char * name : { "out/mine.txt", "out/level1", "out/level2" })
  {
    WriteText(name, "before");
  }
  StagingFolder folder(Path("out"));
  WriteFileAtomically(folder.GetPath() + "/level1", "after");
  folder.Commit([](const std::string & name) { return name.rfind("level", 0) == 0; });
  EXPECT_THAT(Files(), ElementsAre("out", "out/level1", "out/mine.txt"));
  EXPECT_EQ(ReadText("out/level1"), "after");
}

TEST_F(AtomicFileTest, AFolderWhereAFileIsToBeWrittenIsNamed)
{
  std::filesystem::create_directories(Path("out/report.txt"));
  WriteText("out/first", "before");
  StagingFolder folder(Path("out"));
  WriteFileAtomically(folder.GetPath() + "/first", "after");
  WriteFileAtomically(folder.GetPath() + "/report.txt", "text");
  EXPECT_THAT(ErrorOf([&] { folder.Commit(); }), HasSubstr("out/report.txt: is a folder"));
  EXPECT_EQ(ReadText("out/first"), "before");
}

TEST_F(AtomicFileTest, AnEmptyFileIsNotCommitted)
{
  AtomicFile file(Path("a.txt"));
  EXPECT_THAT(ErrorOf([&] { file.Commit(); }), HasSubstr("nothing reached the disk"));
  std::ofstream(file.GetTemporaryPath()).close();
  EXPECT_THAT(ErrorOf([&] { file.Commit(); }), HasSubstr("nothing reached the disk"));
}

TEST_F(AtomicFileTest, PendingTemporariesCanBeRemovedAtOnce)
{
  AtomicFile first(Path("a.mhd")), second(Path("b.nii.gz"));
  std::ofstream(first.GetTemporaryPath()) << "header";
  std::ofstream(std::filesystem::path(first.GetTemporaryPath()).replace_extension(".zraw")) << "data";
  std::ofstream(second.GetTemporaryPath()) << "content";
  RemovePendingTemporaries();
  EXPECT_THAT(Files(), IsEmpty());
  RemovePendingTemporaries();
  EXPECT_THROW(first.Commit(), IOError);
}

TEST_F(AtomicFileTest, AnInterruptedProcessLeavesNothing)
{
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0)
  {
    std::signal(SIGINT, [](int) {
      RemovePendingTemporaries();
      _exit(130);
    });
    AtomicFile file(Path("a.vtu"));
    std::ofstream(file.GetTemporaryPath()) << "half";
    std::raise(SIGINT);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_THAT(Files(), IsEmpty());
}

TEST(ErrorLine, LosesTheClassAndAddressAndLineBreaks)
{
  const auto line = [](const char * text) { return ErrorLine(itk::ExceptionObject("f", 1, text)); };
  EXPECT_EQ(line("ITK ERROR: ContourStack(0x55d0): Slice 1 is\nbad.\n"), "Slice 1 is bad.");
  EXPECT_EQ(line("plain (0x5): text"), "plain (0x5): text");
  EXPECT_EQ(line(""), "");
}
} // namespace bone
