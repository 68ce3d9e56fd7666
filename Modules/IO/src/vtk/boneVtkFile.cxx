/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVtkFile.h"

#include "boneAtomicFile.h"
#include "boneIOError.h"
#include "boneRefuse.h"
#include "boneXmlCheck.h"

#include <vtkCommand.h>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkSTLReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace bone
{
namespace
{
// Keeps VTK's errors and warnings off the standard error stream and remembers the first.
class MessageCatcher : public vtkCommand
{
public:
  vtkTypeMacro(MessageCatcher, vtkCommand);
  static MessageCatcher *
  New()
  {
    return new MessageCatcher;
  }
  void
  Execute(vtkObject *, unsigned long, void * data) override
  {
    if (data != nullptr && m_First.empty())
    {
      m_First = static_cast<const char *>(data);
    }
    m_Any = true;
  }
  bool
  Any() const
  {
    return m_Any;
  }
  // VTK's message without the place in its source: "ERROR: In file, line n\nclass (address): text\n\n".
  std::string
  Text() const
  {
    const auto        colon = m_First.find("): ");
    std::string       text = colon == std::string::npos ? m_First : m_First.substr(colon + 3);
    const std::string blanks = " \n.";
    text.erase(text.find_last_not_of(blanks) + 1);
    return text.find("vtk") == std::string::npos ? text : ""; // what is about VTK's classes helps nobody
  }
  void
  Watch(vtkAlgorithm * algorithm)
  {
    for (vtkObject * object :
         { static_cast<vtkObject *>(algorithm), static_cast<vtkObject *>(algorithm->GetExecutive()) })
    {
      object->AddObserver(vtkCommand::ErrorEvent, this);
      object->AddObserver(vtkCommand::WarningEvent, this);
    }
  }

private:
  std::string m_First;
  bool        m_Any{ false };
};

// Swallows what objects inside a reader, which nobody can watch, say to VTK's window and log.
class SilentWindow : public vtkOutputWindow
{
public:
  vtkTypeMacro(SilentWindow, vtkOutputWindow);
  static SilentWindow *
  New()
  {
    auto * window = new SilentWindow;
    window->InitializeObjectBase();
    return window;
  }
  void
  DisplayText(const char *) override
  {}
};

class QuietVtk
{
public:
  QuietVtk()
    : m_Window(vtkOutputWindow::GetInstance())
    , m_Verbosity(vtkLogger::GetCurrentVerbosityCutoff())
  {
    vtkOutputWindow::SetInstance(vtkNew<SilentWindow>());
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~QuietVtk()
  {
    vtkOutputWindow::SetInstance(m_Window);
    vtkLogger::SetStderrVerbosity(m_Verbosity);
  }
  QuietVtk(const QuietVtk &) = delete;
  QuietVtk &
  operator=(const QuietVtk &) = delete;

private:
  vtkSmartPointer<vtkOutputWindow> m_Window;
  vtkLogger::Verbosity             m_Verbosity;
};

// Refuses or completes what VTK 9.1 crashes at: a field array of an unknown type, and, where a cell array is too short,
// a piece without the PointData element that its error path reads.
template <typename TReader>
class PieceReader : public TReader
{
public:
  static PieceReader *
  New()
  {
    auto * reader = new PieceReader;
    reader->InitializeObjectBase();
    return reader;
  }

protected:
  int
  ReadPrimaryElement(vtkXMLDataElement * primary) override
  {
    vtkXMLDataElement * fields = primary->FindNestedElementWithName("FieldData");
    for (int i = 0; fields != nullptr && i < fields->GetNumberOfNestedElements(); ++i)
    {
      int type = 0;
      if (fields->GetNestedElement(i)->GetWordTypeAttribute("type", type) == 0)
      {
        vtkErrorMacro("A field data array is of no known type.");
        return 0;
      }
    }
    return TReader::ReadPrimaryElement(primary);
  }
  int
  ReadPiece(vtkXMLDataElement * piece) override
  {
    if (piece->FindNestedElementWithName("PointData") == nullptr)
    {
      vtkNew<vtkXMLDataElement> none;
      none->SetName("PointData");
      piece->AddNestedElement(none);
    }
    return TReader::ReadPiece(piece);
  }
};

template <typename TReader>
auto
ReadWith(TReader * reader, MessageCatcher * messages, const std::string & path, const char * kind)
{
  RequireReadableFile(path);
  const QuietVtk quiet;
  messages->Watch(reader);
  reader->SetFileName(path.c_str());
  reader->Update();
  if (messages->Any() || reader->GetErrorCode() != vtkErrorCode::NoError)
  {
    const std::string text = messages->Text();
    throw IOError(path, std::string("is no readable ") + kind + " file" + (text.empty() ? "" : ": " + text));
  }
  return reader->GetOutput();
}

template <typename TReader>
auto
ReadXmlWith(const std::string & path, const char * kind)
{
  RequireReadableFile(path);
  const QuietVtk quiet;
  RequireSoundXml(path);
  vtkNew<MessageCatcher>       messages;
  vtkNew<PieceReader<TReader>> reader;
  reader->SetReaderErrorObserver(messages);
  reader->SetParserErrorObserver(messages);
  auto * output = ReadWith(reader.Get(), messages.Get(), path, kind);
  return vtkSmartPointer<std::remove_pointer_t<decltype(output)>>(output);
}

template <typename TReader>
vtkSmartPointer<vtkPolyData>
ReadSurfaceWith(const std::string & path, const char * kind)
{
  vtkNew<MessageCatcher> messages;
  vtkNew<TReader>        reader;
  return ReadWith(reader.Get(), messages.Get(), path, kind);
}

template <typename TWriter, typename TData>
void
WriteXml(TData * data, AtomicFile & file, FileSize size = FileSize::Quick)
{
  vtkNew<MessageCatcher> messages;
  vtkNew<TWriter>        writer;
  messages->Watch(writer);
  writer->SetInputData(data);
  // VTK 9.1 may crash where the disk is full: it writes to memory.
  writer->WriteToOutputStringOn();
  // Inline base64 compressed by zlib is what other readers of the format (meshio) understand.
  writer->SetDataModeToBinary();
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(size == FileSize::Small ? 9 : 1);
  if (size == FileSize::Small)
  {
    writer->SetBlockSize(std::size_t{ 1 } << 22); // each block is compressed by itself
  }
  writer->SetHeaderTypeToUInt64();
  if (writer->Write() == 0 || messages->Any() || writer->GetErrorCode() != vtkErrorCode::NoError)
  {
    throw MachineError(file.GetPath(), "cannot write: " + messages->Text());
  }
  file.Write(writer->GetOutputString());
}
} // namespace

void
RequireReadableFile(const std::string & path)
{
  namespace fs = std::filesystem;
  std::error_code error;
  const auto      status = fs::status(path, error);
  if (!fs::exists(status))
  {
    throw IOError(path, "there is no such file");
  }
  if (fs::is_directory(status))
  {
    throw IOError(path, "is a folder: name a file");
  }
  if (!fs::is_regular_file(status))
  {
    throw IOError(path, "is no regular file (a pipe or a device): write it to one first");
  }
  if (fs::file_size(path, error) == 0)
  {
    throw IOError(path, "is empty");
  }
  if (!std::ifstream(path))
  {
    throw IOError(path, "cannot be opened for reading");
  }
}

bool
HasExtension(const std::string & path, const std::string & extension)
{
  return path.size() > extension.size() &&
         std::equal(extension.rbegin(), extension.rend(), path.rbegin(), [](unsigned char a, unsigned char b) {
           return std::tolower(a) == std::tolower(b);
         });
}

void
RequireExtension(const std::string & path, const std::vector<std::string> & extensions)
{
  std::string known;
  for (const auto & extension : extensions)
  {
    if (HasExtension(path, extension))
    {
      return;
    }
    known += (known.empty() ? "" : " or ") + extension;
  }
  throw IOError(path, "the name must end in " + known);
}

vtkSmartPointer<vtkXMLDataElement>
ReadXmlFile(const std::string & path)
{
  RequireReadableFile(path);
  const QuietVtk quiet;
  RequireSoundXml(path);
  return vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromFile(path.c_str()));
}

vtkSmartPointer<vtkUnstructuredGrid>
ReadVtuFile(const std::string & path)
{
  return ReadXmlWith<vtkXMLUnstructuredGridReader>(path, "VTK unstructured grid (.vtu)");
}

vtkSmartPointer<vtkPolyData>
ReadVtpFile(const std::string & path)
{
  return ReadXmlWith<vtkXMLPolyDataReader>(path, "VTK poly data (.vtp)");
}

namespace
{
/** VTK takes the memory for as many triangles as a binary STL file says that it has. */
void
RequireTrianglesInFile(const std::string & path)
{
  constexpr std::size_t header = 80;
  constexpr double      triangle = 50.0;
  std::ifstream         stream(path, std::ios::binary);
  std::array<char, 512> start{};
  stream.read(start.data(), start.size());
  const auto end = start.begin() + stream.gcount();
  const bool text =
    std::string(start.data(), 5) == "solid" && std::all_of(start.begin(), end, [](char c) { return c > 0; });
  std::uint32_t count = 0;
  std::memcpy(&count, &start[header], sizeof(count));
  const auto size = static_cast<double>(std::filesystem::file_size(path));
  if (!text && size > header && header + sizeof(count) + triangle * count > size)
  {
    Refuse(
      "is an STL file that is damaged or cut short: it says that it has ", count, " triangles, but is not that long");
  }
}
} // namespace

vtkSmartPointer<vtkPolyData>
ReadStlFile(const std::string & path)
{
  RequireReadableFile(path);
  NamingFile(path, [&path] { RequireTrianglesInFile(path); });
  return ReadSurfaceWith<vtkSTLReader>(path, "STL");
}

void
WriteVtuFile(vtkUnstructuredGrid * grid, AtomicFile & file, FileSize size)
{
  WriteXml<vtkXMLUnstructuredGridWriter>(grid, file, size);
}

void
WriteVtpFile(vtkPolyData * data, AtomicFile & file)
{
  WriteXml<vtkXMLPolyDataWriter>(data, file);
}
} // namespace bone
