/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneReportPage_h
#define boneReportPage_h

#include "boneJson.h"
#include "boneProvenance.h"

#include <string>
#include <vector>

namespace bone
{
/** A table of words. The first cell of a row is its heading. */
struct PageTable
{
  std::string                           caption;
  std::vector<std::string>              header;
  std::vector<std::vector<std::string>> rows;
};

/** \class ReportPage
 * \brief A page that shows a result: one HTML file with all that it needs in it, which opens from disk and asks nothing
 * of a network.
 *
 * Text, tables and pictures can be seen without scripts, and printed. A script draws models in 3D, slices and atlases
 * (\ref PageData); where BoneTK was built without it (HasScript), the page says so in their place. Text is given as it
 * is to be read: what is special in HTML is escaped here. */
class ReportPage
{
public:
  /** `name` of what is shown, as "femur"; `command` that made it, as "build". The title is "BoneTK report: NAME". */
  ReportPage(std::string name, std::string command);

  /** Whether this build of BoneTK holds the page's script. */
  static bool
  HasScript();

  /** Sentences that stand before all else. */
  void
  SetWarnings(std::vector<std::string> warnings);

  /** What follows stands under this heading. `id`: lower case letters and hyphens, one of its kind. */
  void
  BeginSection(const std::string & id, const std::string & title);
  void
  AddText(const std::string & text);
  void
  AddTable(const PageTable & table);
  /** A picture (bytes of a .png, .jpg or .svg file), what it shows for those who cannot see it, and its caption. */
  void
  AddPicture(const std::string & bytes, const std::string & description, const std::string & caption);

  /** What the script draws under the present heading; each once. See PackModel, PackSlices, PackAtlas. */
  void
  AddModel(nlohmann::json model);
  void
  AddSlices(nlohmann::json slices);
  void
  AddAtlas(nlohmann::json atlas);

  /** The last section. */
  void
  AddProvenance(const Provenance & provenance);

  std::string
  GetHtml() const;

  /** The whole file or none. Throws IOError. */
  void
  Write(const std::string & path) const;

private:
  struct Section
  {
    std::string id;
    std::string title;
    std::string body;
  };

  /** The element that the script fills. */
  void
  AddDrawing(const char * id, const char * member, nlohmann::json data);

  std::string              m_Name;
  std::string              m_Command;
  std::vector<std::string> m_Warnings;
  std::vector<Section>     m_Sections;
  nlohmann::json           m_Data;
};
} // namespace bone

#endif
