/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneReportPage.h"

#include "boneAtomicFile.h"
#include "bonePageData.h"
#include "boneReportBundle.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
std::string
Escape(const std::string & text)
{
  std::string escaped;
  for (const char c : text)
  {
    switch (c)
    {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/** "<NAME>text</NAME>" */
std::string
Element(const std::string & name, const std::string & text)
{
  return "<" + name + ">" + Escape(text) + "</" + name.substr(0, name.find(' ')) + ">";
}

std::string
TableHtml(const PageTable & table)
{
  std::string html = "<table>";
  if (!table.caption.empty())
  {
    html += Element("caption", table.caption);
  }
  if (!table.header.empty())
  {
    html += "<thead><tr>";
    for (const std::string & cell : table.header)
    {
      html += Element("th scope=\"col\"", cell);
    }
    html += "</tr></thead>";
  }
  html += "<tbody>";
  for (const auto & row : table.rows)
  {
    html += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c)
    {
      html += Element(c == 0 ? "th scope=\"row\"" : "td", row[c]);
    }
    html += "</tr>";
  }
  return html + "</tbody></table>\n";
}

/** JSON that may stand in a script element: without what ends it. */
std::string
ScriptJson(const nlohmann::json & json)
{
  std::string text = json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
  {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

/** An SVG as an address: a third less than base64, numbers cut to hundredths of a pixel. */
std::string
SvgAddress(const std::string & svg)
{
  std::string address = "data:image/svg+xml,";
  int         decimals = -1; // of the present number; -1 before its point
  for (const char c : svg)
  {
    const bool digit = c >= '0' && c <= '9';
    decimals = c == '.' ? 0 : digit && decimals >= 0 ? decimals + 1 : -1;
    if (decimals > 2)
    {
      continue;
    }
    if (std::string("%#<>\"&").find(c) != std::string::npos)
    {
      constexpr char digits[] = "0123456789ABCDEF";
      address += '%';
      address += digits[c / 16];
      address += digits[c % 16];
    }
    else
    {
      address += c == '\n' ? ' ' : c;
    }
  }
  return address;
}

std::string
Seconds(double seconds)
{
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << seconds;
  return text.str();
}
} // namespace

ReportPage::ReportPage(std::string name, std::string command)
  : m_Name(std::move(name))
  , m_Command(std::move(command))
{
  m_Data["name"] = m_Name;
}

bool
ReportPage::HasScript()
{
  return !ReportBundle().empty();
}

void
ReportPage::SetWarnings(std::vector<std::string> warnings)
{
  m_Warnings = std::move(warnings);
}

void
ReportPage::BeginSection(const std::string & id, const std::string & title)
{
  m_Sections.push_back({ id, title, "" });
}

void
ReportPage::AddText(const std::string & text)
{
  m_Sections.back().body += Element("p", text) + "\n";
}

void
ReportPage::AddTable(const PageTable & table)
{
  m_Sections.back().body += TableHtml(table);
}

void
ReportPage::AddPicture(const std::string & bytes, const std::string & description, const std::string & caption)
{
  const std::string address = bytes.compare(0, 4, "\x89PNG") == 0    ? "data:image/png;base64," + ToBase64(bytes)
                              : bytes.compare(0, 2, "\xff\xd8") == 0 ? "data:image/jpeg;base64," + ToBase64(bytes)
                                                                     : SvgAddress(bytes);
  m_Sections.back().body += "<figure><img src=\"" + address + "\" alt=\"" + Escape(description) + "\">" +
                            Element("figcaption", caption) + "</figure>\n";
}

void
ReportPage::AddDrawing(const char * id, const char * member, nlohmann::json data)
{
  if (!HasScript())
  {
    this->AddText(
      "This build of BoneTK has no script for pages (it was made without npm): there is no interactive view.");
    return;
  }
  m_Sections.back().body += std::string("<div id=\"") + id + "\"></div>\n";
  m_Data[member] = std::move(data);
}

void
ReportPage::AddModel(nlohmann::json model)
{
  this->AddDrawing("viewer", "model", std::move(model));
}

void
ReportPage::AddSlices(nlohmann::json slices)
{
  this->AddDrawing("slices", "slices", std::move(slices));
}

void
ReportPage::AddAtlas(nlohmann::json atlas)
{
  this->AddDrawing("atlas", "atlas", std::move(atlas));
}

void
ReportPage::AddProvenance(const Provenance & provenance)
{
  this->BeginSection("provenance", "Provenance");
  PageTable about{ "", {}, { { "Version", provenance.version }, { "Command", provenance.command } } };
  about.rows.push_back({ "Time", provenance.time });
  about.rows.push_back({ "Machine", provenance.machine });
  this->AddTable(about);
  PageTable inputs{ "Inputs", { "File", "Bytes", "MD5" }, {} };
  for (const InputFile & input : provenance.inputs)
  {
    inputs.rows.push_back({ input.path, std::to_string(input.bytes), input.md5 });
  }
  if (!inputs.rows.empty())
  {
    this->AddTable(inputs);
  }
  PageTable seconds{ "Time by step", { "Step", "Seconds" }, {} };
  double    total = 0.0;
  for (const auto & [step, time] : provenance.seconds)
  {
    seconds.rows.push_back({ step, Seconds(time) });
    total += time;
  }
  if (!seconds.rows.empty())
  {
    seconds.rows.push_back({ "all", Seconds(total) });
    this->AddTable(seconds);
  }
  PageTable parameters{ "", { "Parameter", "Stage", "Value", "Unit", "Meaning" }, {} };
  for (const ParameterValue & p : provenance.parameters)
  {
    parameters.rows.push_back({ p.name, p.stage, p.value, p.unit, p.help });
  }
  if (!parameters.rows.empty())
  {
    m_Sections.back().body += "<details><summary>All parameters</summary>" + TableHtml(parameters) + "</details>\n";
  }
}

std::string
ReportPage::GetHtml() const
{
  const std::string title = "BoneTK report: " + m_Name;
  std::string       html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">" +
                     Element("title", title) + "<style>" + ReportStyle() + "</style></head>\n<body>\n<header>" +
                     Element("h1", m_Name) + Element("p", "BoneTK report of bonetk " + m_Command) + "<nav>";
  for (const Section & section : m_Sections)
  {
    html += "<a href=\"#" + section.id + "\">" + Escape(section.title) + "</a> ";
  }
  html += "</nav></header>\n<main>\n";
  if (!m_Warnings.empty())
  {
    html += "<section class=\"warnings\" role=\"status\"><h2>Warnings</h2><ul>";
    for (const std::string & warning : m_Warnings)
    {
      html += Element("li", warning);
    }
    html += "</ul></section>\n";
  }
  for (const Section & section : m_Sections)
  {
    html += "<section id=\"" + section.id + "\">" + Element("h2", section.title) + "\n" + section.body + "</section>\n";
  }
  html += "</main>\n";
  if (HasScript() && m_Data.size() > 1)
  {
    html += "<script type=\"application/json\" id=\"bonetk-data\">" + ScriptJson(m_Data) + "</script>\n" +
            "<script type=\"application/octet-stream\" id=\"bonetk-bundle\">" + ReportBundle() + "</script>\n" +
            "<script>" + ReportLoader() + "</script>\n";
  }
  else
  {
    html += "<script>document.title += \" \\u2013 rendered\";</script>\n";
  }
  return html + "</body></html>\n";
}

void
ReportPage::Write(const std::string & path) const
{
  WriteFileAtomically(path, this->GetHtml());
}
} // namespace bone
