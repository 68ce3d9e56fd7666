/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
/** Damages files of every format that BoneTK reads, and either reads them and works with what is read, or runs commands
 * of bonetk on them. What may come of it: the file is read, or refused in one line for a person. What may not: a
 * signal, a sanitizer's report, more than ten seconds or 4 GB, or other content than was written where a checksum or a
 * length does not agree. */
#include "boneFuzzChild.h"
#include "boneFuzzCommands.h"
#include "boneFuzzFormats.h"
#include "boneFuzzSeeds.h"

#include "boneIOError.h"

#include <itkMultiThreaderBase.h>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>
#include <new>

namespace
{
namespace fs = std::filesystem;
using bone::ChildEnd;
using bone::FuzzFormat;
using bone::Payload;

/** What came of reading, told by the child through its exit code. */
enum Outcome
{
  Read = 0,
  Refused = 1,
  BadMessage = 2,
  Silent = 3
};

int
Refuse(const std::string & line)
{
  const std::string fault = bone::FindMessageFault(line);
  std::cerr << "refused: " << line << (fault.empty() ? "" : "\nwhich " + fault) << std::endl;
  return fault.empty() ? Refused : BadMessage;
}

/** Runs what reads a file. Returns the outcome. */
int
Try(const std::function<void()> & read)
{
  try
  {
    read();
    return Read;
  }
  catch (const itk::ExceptionObject & error)
  {
    return Refuse(bone::ErrorLine(error));
  }
  catch (const std::bad_alloc &)
  {
    return Refused; // bonetk says that there is not enough memory
  }
  catch (const std::exception & error)
  {
    return Refuse(error.what());
  }
}

struct Counts
{
  std::size_t inputs{ 0 };
  std::size_t read{ 0 };
  std::size_t refused{ 0 };
  std::size_t bad{ 0 };

  void
  Print(const std::string & name) const
  {
    std::cout << name << ": " << inputs << " inputs, " << read << " read, " << refused << " refused, " << bad << " bad"
              << std::endl;
  }
};

class Fuzzer
{
public:
  /** An empty program: readers, else commands of that program. */
  Fuzzer(const std::string & folder, std::string program)
    : m_Program(std::move(program))
    , m_Seeds(folder + "/seeds")
    , m_Work(folder + "/work")
    , m_Keep(folder + "/keep")
    , m_Log(folder + "/child.log")
  {
    fs::create_directories(m_Seeds);
    bone::WriteFuzzSeeds(m_Seeds);
    fs::remove_all(m_Work);
    fs::copy(m_Seeds, m_Work, fs::copy_options::recursive);
    fs::create_directories(m_Work + "/out");
    fs::create_directories(m_Keep);
  }

  bool
  Has(const FuzzFormat & format) const
  {
    return m_Program.empty() ? format.use != nullptr : !format.commands.empty();
  }

  /** Inputs that came out as they must not are kept. */
  Counts
  Run(const FuzzFormat & format, std::size_t count, std::uint64_t seed)
  {
    Counts            counts;
    const std::string bytes = bone::ReadBytes(m_Seeds + "/" + format.file);
    const std::string path = m_Work + "/" + format.file;
    const std::size_t ways = m_Program.empty() ? 1 : format.commands.size();
    for (std::size_t way = 0; way < ways; ++way)
    {
      const ChildEnd end = this->Use(format, way, format.same != nullptr);
      if (!end.wrong.empty() || end.code != Read)
      {
        std::cout << this->Name(format, way) << " fails with the file as it is: " << end.wrong << "; see " << m_Log
                  << std::endl;
        ++counts.bad;
        return counts;
      }
    }
    for (; counts.inputs < count; ++counts.inputs)
    {
      bone::Mutator     mutator(seed * 1000003 + counts.inputs);
      const std::size_t way = mutator.Below(ways);
      const bool        payload = format.payload != Payload::Unchecked && mutator.Below(4) == 0;
      const bool        within = format.gzip && mutator.Below(2) == 0;
      bone::WriteBytes(path,
                       payload  ? mutator.DamagePayload(bytes, format.payload)
                       : within ? mutator.DamageWithin(bytes)
                                : mutator.Damage(bytes));
      const ChildEnd end = this->Use(format, way, payload);
      counts.read += end.wrong.empty() && end.code == Read ? 1 : 0;
      counts.refused += end.wrong.empty() && end.code != Read ? 1 : 0;
      if (!end.wrong.empty())
      {
        ++counts.bad;
        const std::string kept = m_Keep + "/" + std::to_string(seed) + "_" + std::to_string(counts.inputs) + "_" +
                                 fs::path(format.file).filename().string();
        fs::copy_file(path, kept, fs::copy_options::overwrite_existing);
        fs::copy_file(m_Log, kept + ".log", fs::copy_options::overwrite_existing);
        std::cout << this->Name(format, way) << ", input " << counts.inputs << ": " << end.wrong << "; kept as " << kept
                  << std::endl;
      }
    }
    bone::WriteBytes(path, bytes);
    counts.Print(format.file);
    return counts;
  }

private:
  std::string
  Name(const FuzzFormat & format, std::size_t way) const
  {
    return m_Program.empty() ? format.file : format.file + ", bonetk " + format.commands[way];
  }

  /** Reads the file in the work folder, in one way of those that there are. Where it is taken though its payload was
   * damaged, what is read has to be what was written. */
  ChildEnd
  Use(const FuzzFormat & format, std::size_t way, bool compare) const
  {
    const std::string path = m_Work + "/" + format.file;
    const auto        names =
      format.names.empty() ? std::vector<std::string>{ fs::path(format.file).filename().string() } : format.names;
    ChildEnd end = m_Program.empty() ? bone::RunInChild([&] { return Try([&] { format.use(path); }); }, m_Log)
                                     : bone::RunCommand(m_Program, format.commands[way], names, m_Work, m_Log);
    if (end.wrong.empty() && m_Program.empty() && end.code == BadMessage)
    {
      end.wrong = "its message is no line for a person";
    }
    if (end.wrong.empty() && end.code == Read && compare)
    {
      const auto same = [&] {
        bool      found = false;
        const int outcome = Try([&] { found = format.same(path, m_Seeds + "/" + format.file); });
        return outcome == Read && !found ? Silent : Read;
      };
      end = bone::RunInChild(same, m_Log);
      end.wrong = end.wrong.empty() && end.code == Silent ? "damage was not noticed" : end.wrong;
    }
    return end;
  }

  std::string m_Program;
  std::string m_Seeds;
  std::string m_Work;
  std::string m_Keep;
  std::string m_Log;
};
} // namespace

int
main(int argc, char ** argv)
{
  CLI::App      app("Damages files of every format, has them read, and says what must not come of it");
  std::string   folder;
  std::string   only;
  std::string   program;
  std::size_t   count = 20;
  std::uint64_t seed = 1;
  app.add_option("folder", folder, "Where seeds and damaged files are made; what is bad is kept in its keep/")
    ->required();
  app.add_option("--bonetk", program, "This program's commands are run on the files; default: the readers")
    ->check(CLI::ExistingFile);
  app.add_option("--count", count, "Damaged files of each format");
  app.add_option("--seed", seed, "Of the damage");
  app.add_option("--format", only, "Only the format of this file, such as ct.nii.gz");
  CLI11_PARSE(app, argc, argv);

  itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(1); // threads do not live through fork()
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  const auto full = [](const std::string & path) { return path.empty() ? path : fs::absolute(path).string(); };
  Fuzzer     fuzzer(full(folder), full(program));
  Counts     all;
  for (const FuzzFormat & format : bone::FuzzFormats())
  {
    if ((only.empty() || only == format.file) && fuzzer.Has(format))
    {
      const Counts counts = fuzzer.Run(format, count, seed);
      all.inputs += counts.inputs;
      all.read += counts.read;
      all.refused += counts.refused;
      all.bad += counts.bad;
    }
  }
  all.Print("all formats");
  return all.bad == 0 ? 0 : 1;
}
