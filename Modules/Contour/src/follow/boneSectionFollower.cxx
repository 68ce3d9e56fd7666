/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionFollower.h"

#include "boneBodyLabels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace bone
{
namespace
{
constexpr int        Drawn = 1; // the body that was drawn
constexpr const char EndsAtJoint[] = "a piece ends at a joint";

// A plane to be followed.
struct FinePlane
{
  double      height;
  int         section; // its index, -1: between sections
  std::string event;
};

void
AddEvent(std::string & events, const std::string & event)
{
  events += (events.empty() ? "" : "; ") + event;
}

// One following: bodies, and what each section's pixels belong to.
class Following
{
public:
  Following(const PlaneSource &          planes,
            const Vector2 &              pixel,
            const FollowParameters &     parameters,
            const std::vector<Section> & sections,
            double                       spacing,
            const Execution &            execution)
    : m_Planes(planes)
    , m_Pixel(pixel)
    , m_P(parameters)
    , m_Sections(sections)
    , m_Runs(sections.size())
    , m_Bodies(Drawn + 1)
    , m_Execution(execution)
  {
    for (std::size_t k = 0; k < sections.size(); ++k)
    {
      if (k > 0)
      {
        const double low = sections[k - 1].height;
        const double gap = sections[k].height - low;
        const int    parts = std::max(1, static_cast<int>(std::ceil(gap / spacing - 1e-3)));
        for (int i = 1; i < parts; ++i)
        {
          m_Fine.push_back({ low + gap * i / parts, -1, {} });
        }
      }
      m_Fine.push_back({ sections[k].height, static_cast<int>(k), {} });
    }
  }

  void
  Run()
  {
    std::vector<std::size_t> drawn;
    for (std::size_t f = 0; f < m_Fine.size(); ++f)
    {
      if (m_Fine[f].section >= 0 && !m_Sections[static_cast<std::size_t>(m_Fine[f].section)].pieces.empty())
      {
        drawn.push_back(f);
      }
    }
    for (std::size_t d = 0; d < drawn.size(); ++d)
    {
      const std::size_t first = d > 0 ? (drawn[d - 1] + drawn[d]) / 2 + 1 : 0;
      const std::size_t last = d + 1 < drawn.size() ? (drawn[d] + drawn[d + 1]) / 2 : m_Fine.size() - 1;
      this->RunFrom(drawn[d], first, last);
    }
  }

  std::vector<Polygon>
  OutlinesOf(std::size_t section) const
  {
    return m_Runs[section].OutlinesOf([this](int body) { return m_Bodies.Find(body) == m_Bodies.Find(Drawn); });
  }

  std::vector<std::string>
  Events() const
  {
    std::vector<std::string> events(m_Sections.size());
    std::string              between;
    for (const FinePlane & plane : m_Fine)
    {
      if (!plane.event.empty())
      {
        AddEvent(between, plane.event);
      }
      if (plane.section >= 0)
      {
        events[static_cast<std::size_t>(plane.section)] = std::move(between);
        between.clear();
      }
    }
    return events;
  }

private:
  bool
  IsOurs(int body) const
  {
    return body > 0 && m_Bodies.Find(body) == m_Bodies.Find(Drawn);
  }

  PlaneField
  PlaneAt(double height) const
  {
    PlaneField plane = m_Planes(height, Vector2::Constant(-1e6), Vector2::Constant(1e6));
    SmoothField(plane, m_P.smoothing > 0.0 ? m_P.smoothing : 0.55 * m_Pixel.maxCoeff());
    return plane;
  }

  // Both ways from a drawn plane; again where a body joined late was left alive beyond the end of the first pass.
  void
  RunFrom(std::size_t drawn, std::size_t first, std::size_t last)
  {
    const BodyLabels start = this->LabelsOfDrawn(drawn);
    this->Store(drawn, start);
    for (int pass = 0; pass < 3; ++pass)
    {
      const std::set<int> above = this->RunToEnd(start, drawn, last, 1);
      const std::set<int> below = this->RunToEnd(start, drawn, first, -1);
      const auto          left = [this](const std::set<int> & alive) {
        return std::any_of(alive.begin(), alive.end(), [this](int body) { return this->IsOurs(body); });
      };
      if (!left(above) && !left(below))
      {
        break;
      }
    }
  }

  // What a person drew, and around it what else is bone there.
  BodyLabels
  LabelsOfDrawn(std::size_t f)
  {
    const PlaneField plane = this->PlaneAt(m_Fine[f].height);
    const auto       section = static_cast<std::size_t>(m_Fine[f].section);
    return BodyLabels::FromDrawing(plane, m_Sections[section].pieces, m_P, m_Bodies);
  }

  void
  Store(std::size_t f, const BodyLabels & labels)
  {
    if (m_Fine[f].section >= 0)
    {
      m_Runs[static_cast<std::size_t>(m_Fine[f].section)] = labels.Compress();
    }
  }

  // Returns the bodies that were alive where the run ended for want of the drawn one.
  std::set<int>
  RunToEnd(const BodyLabels & start, std::size_t from, std::size_t to, int direction)
  {
    BodyLabels before = start;
    History    history;
    for (std::size_t f = from; f != to;)
    {
      const double height = m_Fine[f].height;
      m_Execution.Report(static_cast<double>(++m_Followed) / static_cast<double>(m_Fine.size()));
      f = direction > 0 ? f + 1 : f - 1;
      std::vector<BodyContact> contacts;
      BodyLabels now = BodyLabels::Continue(this->PlaneAt(m_Fine[f].height), before, m_P, m_Bodies, contacts);
      m_Fine[f].event.clear();
      this->JudgeContacts(contacts, std::abs(m_Fine[f].height - height), history, now, m_Fine[f]);
      this->NoteChange(before, now, m_Fine[f]);
      if (!now.Any([this](int body) { return this->IsOurs(body); }))
      {
        this->NoteEnd(before, f, direction, m_Fine[f].event.find(EndsAtJoint) != std::string::npos);
        return now.Bodies();
      }
      this->Store(f, now);
      before = std::move(now);
    }
    return {};
  }

  // Areas (mm^2) over which two bodies have touched so far, with a valley between them and without.
  struct Touch
  {
    double joint{ 0.0 };
    double solid{ 0.0 };
  };
  using History = std::map<std::pair<int, int>, Touch>;

  void
  Join(int a, int b, History & history)
  {
    m_Bodies.Join(a, b);
    History renamed;
    for (const auto & item : history)
    {
      const auto pair = std::minmax({ m_Bodies.Find(item.first.first), m_Bodies.Find(item.first.second) });
      if (pair.first != pair.second)
      {
        Touch & touch = renamed[{ pair.first, pair.second }];
        touch.joint += item.second.joint;
        touch.solid += item.second.solid;
      }
    }
    history = std::move(renamed);
  }

  // Joins bodies whose contact is bone throughout. Where a bone that was parted from another by a joint is suddenly one
  // with it all around, it has ended, and what lies here is the other.
  void
  JudgeContacts(const std::vector<BodyContact> & contacts,
                double                           step,
                History &                        history,
                BodyLabels &                     now,
                FinePlane &                      plane)
  {
    bool joins = false;
    bool touches = false;
    bool ends = false;
    for (const BodyContact & contact : contacts)
    {
      const int a = m_Bodies.Find(contact.a);
      const int b = m_Bodies.Find(contact.b);
      if (a == b)
      {
        continue;
      }
      const bool   ours = this->IsOurs(a) || this->IsOurs(b);
      const bool   solid = contact.valley < m_P.valleyDepth * contact.sides;
      Touch &      touch = history[std::minmax(a, b)];
      const double smaller = std::min(contact.areaOfA, contact.areaOfB);
      if (solid && touch.joint > touch.solid + m_P.contactArea &&
          contact.length > 0.5 * std::sqrt(4.0 * M_PI * smaller))
      {
        const bool first = contact.areaOfA < contact.areaOfB;
        ends = ends || this->IsOurs(first ? a : b);
        now.Absorb(first ? contact.pixelOfA : contact.pixelOfB, first ? b : a);
        continue;
      }
      (solid ? touch.solid : touch.joint) += step * contact.length;
      if (solid && contact.length >= m_P.contactWidth && touch.solid - touch.joint >= m_P.contactArea)
      {
        this->Join(a, b, history);
        joins = joins || ours;
        continue;
      }
      touches = touches || ours;
    }
    if (joins)
    {
      AddEvent(plane.event, "another piece joins");
    }
    if (ends)
    {
      AddEvent(plane.event, EndsAtJoint);
    }
    if (touches)
    {
      AddEvent(plane.event, "touches another bone, parted along the darkest line");
    }
  }

  void
  NoteChange(const BodyLabels & before, const BodyLabels & now, FinePlane & plane) const
  {
    const auto   ours = [this](int body) { return this->IsOurs(body); };
    const double a = before.Area(ours);
    const double b = now.Area(ours);
    if (b > 0.0 && std::abs(b - a) > m_P.suddenArea && (b > 1.5 * a || b < 0.6 * a))
    {
      std::ostringstream text;
      text.precision(2);
      text << "its area changes suddenly, by a factor of " << b / a;
      AddEvent(plane.event, text.str());
    }
  }

  void
  NoteEnd(const BodyLabels & before, std::size_t f, int direction, bool joint)
  {
    const std::size_t last = direction > 0 ? f - 1 : f + 1;
    std::string       text = joint ? EndsAtJoint : "the bone ends";
    for (std::size_t g = f; !joint && std::abs(m_Fine[g].height - m_Fine[last].height) <= m_P.lookAhead;)
    {
      const PlaneField plane = this->PlaneAt(m_Fine[g].height);
      if (before.Overlap(plane, m_P.threshold, [this](int body) { return this->IsOurs(body); }) > 0.5)
      {
        std::ostringstream gap;
        gap << " or has a gap: there is bone again " << std::abs(m_Fine[g].height - m_Fine[last].height)
            << " mm further on; draw a contour there if it belongs to it";
        text += gap.str();
        break;
      }
      if (g == (direction > 0 ? m_Fine.size() - 1 : 0))
      {
        break;
      }
      g = direction > 0 ? g + 1 : g - 1;
    }
    // The event stands at the last section that has bone.
    std::size_t at = last;
    while (m_Fine[at].section < 0 && at != (direction > 0 ? 0 : m_Fine.size() - 1))
    {
      at = direction > 0 ? at - 1 : at + 1;
    }
    AddEvent(m_Fine[at].event, text);
  }

  const PlaneSource &          m_Planes;
  Vector2                      m_Pixel;
  const FollowParameters &     m_P;
  const std::vector<Section> & m_Sections;
  std::vector<FinePlane>       m_Fine;
  std::vector<BodyRuns>        m_Runs;
  mutable BodyTable            m_Bodies;
  const Execution &            m_Execution;
  std::size_t                  m_Followed{ 0 };
};
} // namespace

SectionFollower::SectionFollower(const PlaneSource & planes, const Vector2 & pixel, const FollowParameters & parameters)
  : m_Planes(planes)
  , m_Pixel(pixel)
  , m_Parameters(parameters)
{}

std::vector<std::string>
SectionFollower::Follow(std::vector<Section> & sections, double spacing, const Execution & execution) const
{
  std::vector<Section> result = sections;
  Following            following(m_Planes, m_Pixel, m_Parameters, sections, spacing, execution);
  following.Run();
  for (std::size_t k = 0; k < sections.size(); ++k)
  {
    int dropped = 0;
    result[k].pieces = GroupPieces(following.OutlinesOf(k), m_Parameters.minimumArea, dropped);
  }
  sections = std::move(result);
  return following.Events();
}
} // namespace bone
