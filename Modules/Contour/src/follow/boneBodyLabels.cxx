/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBodyLabels.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <queue>

namespace bone
{
namespace
{
constexpr double CoreDepth = 1.2;    // mm: what lies so deep in a body is still its on the next slice
constexpr double ContactDepth = 3.5; // mm: so near to another body it is not certain
constexpr double SideReach = 2.5;    // mm: on both sides of a contact, where its sides' height is taken
constexpr double ValleyReach = 1.5;  // mm: narrower dark lines are valleys up to twice as wide
constexpr float  ValleyUnit = 6.0F;  // HU: so deep a valley doubles a step's cost
constexpr double SmallVoid = 6.0;    // mm^2: enclosed regions below are not holes
constexpr double MostlyShare = 0.6;  // of a part of bone that was drawn

// Offsets of a pixel's neighbours on a grid, the four next to it first.
class Neighbours
{
public:
  explicit Neighbours(const PlaneGrid & grid)
    : m_Columns(grid.size[0])
    , m_Rows(grid.size[1])
  {}

  template <typename TVisit>
  void
  Visit(std::size_t n, int count, TVisit && visit) const
  {
    static constexpr int dx[8] = { 1, 0, -1, 0, 1, -1, -1, 1 };
    static constexpr int dy[8] = { 0, 1, 0, -1, 1, 1, -1, -1 };
    const int            i = static_cast<int>(n % static_cast<std::size_t>(m_Columns));
    const int            j = static_cast<int>(n / static_cast<std::size_t>(m_Columns));
    for (int k = 0; k < count; ++k)
    {
      const int x = i + dx[k];
      const int y = j + dy[k];
      if (x >= 0 && y >= 0 && x < m_Columns && y < m_Rows)
      {
        visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(m_Columns) + static_cast<std::size_t>(x));
      }
    }
  }

  bool
  AtBorder(std::size_t n) const
  {
    const int i = static_cast<int>(n % static_cast<std::size_t>(m_Columns));
    const int j = static_cast<int>(n / static_cast<std::size_t>(m_Columns));
    return i == 0 || j == 0 || i == m_Columns - 1 || j == m_Rows - 1;
  }

private:
  int m_Columns;
  int m_Rows;
};

// Connected sets of the pixels for which `in` holds.
template <typename TIn>
std::vector<std::vector<std::size_t>>
Components(const PlaneGrid & grid, int neighbours, TIn && in)
{
  const Neighbours                      around(grid);
  std::vector<char>                     seen(grid.Count(), 0);
  std::vector<std::vector<std::size_t>> components;
  for (std::size_t start = 0; start < grid.Count(); ++start)
  {
    if (seen[start] != 0 || !in(start))
    {
      continue;
    }
    std::vector<std::size_t> pixels{ start };
    seen[start] = 1;
    for (std::size_t next = 0; next < pixels.size(); ++next)
    {
      around.Visit(pixels[next], neighbours, [&](std::size_t m) {
        if (seen[m] == 0 && in(m))
        {
          seen[m] = 1;
          pixels.push_back(m);
        }
      });
    }
    components.push_back(std::move(pixels));
  }
  return components;
}

// Grows the pixels that are set by `radius` pixels, into those that `open` allows.
template <typename TOpen>
void
Grow(const PlaneGrid & grid, std::vector<char> & set, int radius, TOpen && open)
{
  const Neighbours         around(grid);
  std::vector<std::size_t> front;
  for (std::size_t n = 0; n < set.size(); ++n)
  {
    if (set[n] != 0)
    {
      bool edge = false;
      around.Visit(n, 8, [&](std::size_t m) { edge = edge || set[m] == 0; });
      if (edge)
      {
        front.push_back(n);
      }
    }
  }
  for (int step = 0; step < radius; ++step)
  {
    std::vector<std::size_t> next;
    for (const std::size_t n : front)
    {
      around.Visit(n, step % 2 == 0 ? 4 : 8, [&](std::size_t m) { // an octagon
        if (set[m] == 0 && open(m))
        {
          set[m] = 1;
          next.push_back(m);
        }
      });
    }
    front = std::move(next);
  }
}

// Largest or smallest value within `radius` pixels along an axis.
void
SlideExtreme(PlaneField & field, int axis, int radius, bool largest)
{
  const int          n = field.grid.size[static_cast<std::size_t>(axis)];
  const int          lines = field.grid.size[static_cast<std::size_t>(1 - axis)];
  std::vector<float> line(static_cast<std::size_t>(n));
  for (int l = 0; l < lines; ++l)
  {
    const auto at = [&](int i) { return axis == 0 ? field.grid.Offset(i, l) : field.grid.Offset(l, i); };
    for (int i = 0; i < n; ++i)
    {
      line[static_cast<std::size_t>(i)] = field.values[at(i)];
    }
    for (int i = 0; i < n; ++i)
    {
      float & value = field.values[at(i)];
      for (int k = std::max(0, i - radius); k <= std::min(n - 1, i + radius); ++k)
      {
        const float other = line[static_cast<std::size_t>(k)];
        value = largest ? std::max(value, other) : std::min(value, other);
      }
    }
  }
}

int
PixelsIn(double length, const PlaneGrid & grid)
{
  return std::max(1, static_cast<int>(std::lround(length / grid.spacing.maxCoeff())));
}

double
PixelArea(const PlaneGrid & grid)
{
  return grid.spacing.x() * grid.spacing.y();
}
} // namespace

// Depth (HU) of narrow dark valleys around some pixels: the grey-scale closing less the image.
class Valleys
{
public:
  Valleys(const PlaneField & plane, const std::vector<std::size_t> & pixels)
    : m_Columns(static_cast<std::size_t>(plane.grid.size[0]))
  {
    const int radius = PixelsIn(ValleyReach, plane.grid);
    int       low[2] = { plane.grid.size[0], plane.grid.size[1] };
    int       high[2] = { 0, 0 };
    for (const std::size_t n : pixels)
    {
      const int at[2] = { static_cast<int>(n % m_Columns), static_cast<int>(n / m_Columns) };
      for (int a = 0; a < 2; ++a)
      {
        low[a] = std::min(low[a], at[a]);
        high[a] = std::max(high[a], at[a]);
      }
    }
    for (std::size_t a = 0; a < 2; ++a)
    {
      m_Low[a] = std::max(0, low[a] - 2 * radius);
      m_Depth.grid.size[a] = std::min(plane.grid.size[a], high[a] + 2 * radius + 1) - m_Low[a];
    }
    const auto crop = [&](const std::function<void(float &, float)> & visit) {
      for (int j = 0; j < m_Depth.grid.size[1]; ++j)
      {
        for (int i = 0; i < m_Depth.grid.size[0]; ++i)
        {
          visit(m_Depth.values[m_Depth.grid.Offset(i, j)], plane.values[plane.grid.Offset(i + m_Low[0], j + m_Low[1])]);
        }
      }
    };
    m_Depth.values.resize(m_Depth.grid.Count());
    crop([](float & depth, float value) { depth = value; });
    for (const bool largest : { true, false })
    {
      SlideExtreme(m_Depth, 0, radius, largest);
      SlideExtreme(m_Depth, 1, radius, largest);
    }
    crop([](float & depth, float value) { depth -= value; });
  }

  float
  Depth(std::size_t n) const
  {
    return m_Depth.values[m_Depth.grid.Offset(static_cast<int>(n % m_Columns) - m_Low[0],
                                              static_cast<int>(n / m_Columns) - m_Low[1])];
  }

private:
  std::size_t m_Columns;
  int         m_Low[2];
  PlaneField  m_Depth;
};

BodyTable::BodyTable(int count)
{
  for (int body = 0; body < count; ++body)
  {
    m_Parent.push_back(body);
  }
}

int
BodyTable::New()
{
  m_Parent.push_back(static_cast<int>(m_Parent.size()));
  return m_Parent.back();
}

int
BodyTable::Find(int body) const
{
  while (m_Parent[static_cast<std::size_t>(body)] != body)
  {
    body = m_Parent[static_cast<std::size_t>(body)];
  }
  return body;
}

void
BodyTable::Join(int a, int b)
{
  a = this->Find(a);
  b = this->Find(b);
  m_Parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

std::vector<Polygon>
BodyRuns::OutlinesOf(const std::function<bool(int)> & chosen) const
{
  int low[2] = { std::numeric_limits<int>::max(), std::numeric_limits<int>::max() };
  int high[2] = { -1, -1 };
  for (const Run & run : m_Runs)
  {
    if (chosen(run.body))
    {
      low[0] = std::min(low[0], run.begin);
      high[0] = std::max(high[0], run.end - 1);
      low[1] = std::min(low[1], run.row);
      high[1] = std::max(high[1], run.row);
    }
  }
  if (high[0] < 0)
  {
    return {};
  }
  constexpr int margin = 3;
  PlaneField    field;
  field.grid = m_Grid;
  for (std::size_t a = 0; a < 2; ++a)
  {
    field.grid.size[a] = high[a] - low[a] + 1 + 2 * margin;
  }
  field.grid.origin = m_Grid.Node(low[0] - margin, low[1] - margin);
  field.values.assign(field.grid.Count(), 0.0F);
  for (const Run & run : m_Runs)
  {
    if (chosen(run.body))
    {
      const auto row = field.values.begin() +
                       static_cast<std::ptrdiff_t>(field.grid.Offset(margin - low[0], run.row - low[1] + margin));
      std::fill(row + run.begin, row + run.end, 1.0F);
    }
  }
  SmoothField(field, 0.7 * m_Grid.spacing.maxCoeff());
  return ExtractLevelContours(field, 0.5);
}

BodyLabels::BodyLabels(const PlaneGrid & grid)
  : m_Grid(grid)
  , m_Body(grid.Count(), 0)
{}

BodyLabels
BodyLabels::FromDrawing(const PlaneField &                plane,
                        const std::vector<SectionPiece> & pieces,
                        const BodyRules &                 rules,
                        BodyTable &                       bodies)
{
  std::vector<Polygon> loops;
  for (const SectionPiece & piece : pieces)
  {
    loops.push_back(piece.outer);
    loops.insert(loops.end(), piece.holes.begin(), piece.holes.end());
  }
  BodyLabels          drawn(plane.grid);
  const DistanceField distance = ComputeDistanceField(loops, plane.grid, 4.0 * plane.grid.spacing.maxCoeff());
  const float         slack = static_cast<float>(plane.grid.spacing.maxCoeff());
  for (std::size_t n = 0; n < drawn.m_Body.size(); ++n)
  {
    drawn.m_Body[n] = distance.distance.values[n] > 0.0F ? 1 : 0;
  }
  BodyLabels labels(plane.grid);
  for (const auto & part : Components(plane.grid, 8, [&](std::size_t n) { return plane.values[n] > rules.threshold; }))
  {
    std::size_t inside = 0;
    for (const std::size_t n : part)
    {
      inside += drawn.m_Body[n] == 1;
    }
    const bool whole = static_cast<double>(inside) > MostlyShare * static_cast<double>(part.size());
    for (const std::size_t n : part)
    {
      if (whole || (inside > 0 && distance.distance.values[n] > -slack))
      {
        labels.m_Body[n] = 1;
      }
    }
  }
  for (const auto & part : Components(
         plane.grid, 8, [&](std::size_t n) { return plane.values[n] > rules.threshold && labels.m_Body[n] == 0; }))
  {
    if (static_cast<double>(part.size()) * PixelArea(plane.grid) >= rules.minimumArea)
    {
      const int body = bodies.New();
      for (const std::size_t n : part)
      {
        labels.m_Body[n] = body;
      }
    }
  }
  labels.FillEnclosed(drawn, rules);
  return labels;
}

BodyLabels
BodyLabels::Continue(const PlaneField &         plane,
                     const BodyLabels &         before,
                     const BodyRules &          rules,
                     BodyTable &                bodies,
                     std::vector<BodyContact> & contacts)
{
  BodyLabels roots = before;
  for (int & body : roots.m_Body)
  {
    body = body > 0 ? bodies.Find(body) : 0;
  }
  BodyLabels labels(plane.grid);
  labels.Part(plane, roots, rules, bodies, contacts);
  labels.FillEnclosed(roots, rules);
  return labels;
}

std::vector<int>
BodyLabels::Cores() const
{
  const Neighbours  around(m_Grid);
  std::vector<char> rim(m_Body.size(), 0);
  std::vector<char> border(m_Body.size(), 0);
  for (std::size_t n = 0; n < m_Body.size(); ++n)
  {
    if (m_Body[n] > 0)
    {
      around.Visit(n, 8, [&](std::size_t m) {
        rim[n] = rim[n] != 0 || m_Body[m] != m_Body[n];
        border[n] = border[n] != 0 || (m_Body[m] > 0 && m_Body[m] != m_Body[n]);
      });
    }
  }
  const auto within = [this](std::size_t n) { return m_Body[n] > 0; };
  Grow(m_Grid, rim, PixelsIn(CoreDepth, m_Grid) - 1, within);
  Grow(m_Grid, border, PixelsIn(ContactDepth, m_Grid) - 1, within);
  std::vector<int> cores = m_Body;
  for (std::size_t n = 0; n < cores.size(); ++n)
  {
    cores[n] = rim[n] != 0 || border[n] != 0 ? 0 : cores[n];
  }
  return cores;
}

void
BodyLabels::Part(const PlaneField &         plane,
                 const BodyLabels &         before,
                 const BodyRules &          rules,
                 BodyTable &                bodies,
                 std::vector<BodyContact> & contacts)
{
  std::vector<int>           cores;
  std::map<int, std::size_t> areas;
  for (const int body : before.m_Body)
  {
    if (body > 0)
    {
      ++areas[body];
    }
  }
  for (const auto & part : Components(m_Grid, 8, [&](std::size_t n) { return plane.values[n] > rules.threshold; }))
  {
    std::map<int, std::size_t> over;
    for (const std::size_t n : part)
    {
      if (before.m_Body[n] > 0)
      {
        ++over[before.m_Body[n]];
      }
    }
    if (over.empty() && static_cast<double>(part.size()) * PixelArea(m_Grid) < rules.minimumArea)
    {
      continue;
    }
    if (over.size() < 2)
    {
      const int body = over.empty() ? bodies.New() : over.begin()->first;
      for (const std::size_t n : part)
      {
        m_Body[n] = body;
      }
      continue;
    }
    // A body has a say where it holds on deeply, or where much of it or of the part is concerned.
    cores = cores.empty() ? before.Cores() : cores;
    std::map<int, std::size_t> deep;
    for (const std::size_t n : part)
    {
      ++deep[cores[n]];
    }
    const auto hasSay = [&](int body) {
      return deep[body] > 0 || 5 * over[body] > part.size() || 5 * over[body] > areas[body];
    };
    const int largest = std::max_element(over.begin(), over.end(), [](const auto & a, const auto & b) {
                          return a.second < b.second;
                        })->first;
    for (const std::size_t n : part)
    {
      const int body = before.m_Body[n];
      m_Body[n] = body > 0 && (hasSay(body) || body == largest) && (cores[n] > 0 || deep[body] == 0) ? body : 0;
    }
    this->Contest(plane, part, rules, contacts);
  }
}

// Parts connected bone between the bodies that some of its pixels have: the others go to the body from which they are
// reached most cheaply, a step being dearer in narrow dark valleys.
void
BodyLabels::Contest(const PlaneField &               plane,
                    const std::vector<std::size_t> & part,
                    const BodyRules &                rules,
                    std::vector<BodyContact> &       contacts)
{
  struct Item
  {
    float       cost;
    std::size_t order;
    std::size_t pixel;
    int         body;
    bool
    operator<(const Item & other) const
    {
      return cost > other.cost || (!(other.cost > cost) && order > other.order);
    }
  };
  constexpr int             Open = -1;
  const Neighbours          around(m_Grid);
  const Valleys             valleys(plane, part);
  std::priority_queue<Item> queue;
  std::size_t               order = 0;
  const auto                offer = [&](std::size_t n, float cost) {
    int side = 0;
    around.Visit(n, 8, [&](std::size_t m) {
      if (m_Body[m] == Open)
      {
        const float length = side < 4 ? 1.0F : 1.4142F;
        queue.push({ cost + length * (1.0F + valleys.Depth(m) / ValleyUnit), order++, m, m_Body[n] });
      }
      ++side;
    });
  };
  for (const std::size_t n : part)
  {
    m_Body[n] = m_Body[n] > 0 ? m_Body[n] : Open;
  }
  for (const std::size_t n : part)
  {
    if (m_Body[n] > 0)
    {
      offer(n, 0.0F);
    }
  }
  while (!queue.empty())
  {
    const Item item = queue.top();
    queue.pop();
    if (m_Body[item.pixel] == Open)
    {
      m_Body[item.pixel] = item.body;
      offer(item.pixel, item.cost);
    }
  }
  this->AddContacts(plane, part, valleys, rules, contacts);
}

void
BodyLabels::AddContacts(const PlaneField &               plane,
                        const std::vector<std::size_t> & part,
                        const Valleys &                  valleys,
                        const BodyRules &                rules,
                        std::vector<BodyContact> &       contacts) const
{
  const int  reach = PixelsIn(SideReach, m_Grid);
  const auto columns = static_cast<std::size_t>(m_Grid.size[0]);
  const auto highest = [&](std::size_t at, int body) {
    const int i = static_cast<int>(at % columns);
    const int j = static_cast<int>(at / columns);
    float     value = -std::numeric_limits<float>::max();
    for (int y = std::max(0, j - reach); y <= std::min(m_Grid.size[1] - 1, j + reach); ++y)
    {
      for (int x = std::max(0, i - reach); x <= std::min(m_Grid.size[0] - 1, i + reach); ++x)
      {
        const std::size_t n = m_Grid.Offset(x, y);
        value = m_Body[n] == body ? std::max(value, plane.values[n]) : value;
      }
    }
    return value;
  };
  const double               length = 0.8 * m_Grid.spacing.mean(); // a step of a border's staircase, on average
  std::map<int, std::size_t> count;
  std::vector<BodyContact>   found;
  for (const std::size_t n : part)
  {
    ++count[m_Body[n]];
    for (const std::size_t m : { n + 1, n + columns })
    {
      if (m >= m_Body.size() || (m == n + 1 && m % columns == 0))
      {
        continue;
      }
      const int a = m_Body[n];
      const int b = m_Body[m];
      if (a <= 0 || b <= 0 || a == b)
      {
        continue;
      }
      const auto pair = std::minmax(a, b);
      auto       contact = std::find_if(
        found.begin(), found.end(), [&pair](const BodyContact & c) { return c.a == pair.first && c.b == pair.second; });
      if (contact == found.end())
      {
        contact = found.insert(contact, BodyContact());
        contact->a = pair.first;
        contact->b = pair.second;
        contact->pixelOfA = a < b ? n : m;
        contact->pixelOfB = a < b ? m : n;
      }
      contact->length += length;
      contact->valley += length * std::max(valleys.Depth(n), valleys.Depth(m));
      contact->sides += length * (std::min(highest(n, a), highest(m, b)) - rules.softTissue);
    }
  }
  for (BodyContact & contact : found)
  {
    contact.areaOfA = static_cast<double>(count[contact.a]) * PixelArea(m_Grid);
    contact.areaOfB = static_cast<double>(count[contact.b]) * PixelArea(m_Grid);
    contacts.push_back(contact);
  }
}

void
BodyLabels::Absorb(std::size_t pixel, int body)
{
  const Neighbours         around(m_Grid);
  const int                old = m_Body[pixel];
  std::vector<std::size_t> front{ pixel };
  m_Body[pixel] = body;
  for (std::size_t next = 0; next < front.size(); ++next)
  {
    around.Visit(front[next], 8, [&](std::size_t m) {
      if (m_Body[m] == old)
      {
        m_Body[m] = body;
        front.push_back(m);
      }
    });
  }
}

void
BodyLabels::FillEnclosed(const BodyLabels & before, const BodyRules & rules)
{
  const int         radius = PixelsIn(rules.closing, m_Grid);
  std::vector<char> wall(m_Body.size(), 0);
  for (std::size_t n = 0; n < wall.size(); ++n)
  {
    wall[n] = m_Body[n] > 0;
  }
  Grow(m_Grid, wall, radius, [](std::size_t) { return true; });
  const std::set<int> known = before.Bodies();
  const Neighbours    around(m_Grid);
  std::vector<char>   outside(m_Body.size(), 0);
  for (const auto & region : Components(m_Grid, 4, [&](std::size_t n) { return wall[n] == 0; }))
  {
    bool        open = false;
    std::size_t within = 0;
    for (const std::size_t n : region)
    {
      open = open || around.AtBorder(n);
      within += before.m_Body[n] > 0;
    }
    const bool small = static_cast<double>(region.size()) * PixelArea(m_Grid) < SmallVoid;
    if (open || (2 * within < region.size() && !small))
    {
      for (const std::size_t n : region)
      {
        outside[n] = 1;
      }
    }
  }
  Grow(m_Grid, outside, radius + 1, [this](std::size_t n) { return m_Body[n] <= 0; });
  // What is left has the body next to it.
  std::vector<std::size_t> front;
  for (std::size_t n = 0; n < m_Body.size(); ++n)
  {
    if (m_Body[n] > 0)
    {
      front.push_back(n);
    }
  }
  for (std::size_t next = 0; next < front.size(); ++next)
  {
    const int body = m_Body[front[next]];
    around.Visit(front[next], 4, [&](std::size_t m) {
      if (m_Body[m] <= 0 && outside[m] == 0)
      {
        m_Body[m] = body;
        front.push_back(m);
      }
    });
  }
}

BodyRuns
BodyLabels::Compress() const
{
  BodyRuns runs;
  runs.m_Grid = m_Grid;
  for (int j = 0; j < m_Grid.size[1]; ++j)
  {
    for (int i = 0; i < m_Grid.size[0];)
    {
      const int body = m_Body[m_Grid.Offset(i, j)];
      int       end = i + 1;
      while (end < m_Grid.size[0] && m_Body[m_Grid.Offset(end, j)] == body)
      {
        ++end;
      }
      if (body > 0)
      {
        runs.m_Runs.push_back({ j, i, end, body });
      }
      i = end;
    }
  }
  return runs;
}

std::set<int>
BodyLabels::Bodies() const
{
  std::set<int> bodies;
  for (const int body : m_Body)
  {
    if (body > 0)
    {
      bodies.insert(body);
    }
  }
  return bodies;
}

bool
BodyLabels::Any(const std::function<bool(int)> & chosen) const
{
  const std::set<int> bodies = this->Bodies();
  return std::any_of(bodies.begin(), bodies.end(), chosen);
}

double
BodyLabels::Area(const std::function<bool(int)> & chosen) const
{
  std::size_t count = 0;
  for (const int body : m_Body)
  {
    count += body > 0 && chosen(body);
  }
  return static_cast<double>(count) * PixelArea(m_Grid);
}

double
BodyLabels::Overlap(const PlaneField & plane, double threshold, const std::function<bool(int)> & chosen) const
{
  std::size_t count = 0;
  std::size_t bright = 0;
  for (std::size_t n = 0; n < m_Body.size(); ++n)
  {
    if (m_Body[n] > 0 && chosen(m_Body[n]))
    {
      ++count;
      bright += plane.values[n] > threshold;
    }
  }
  return count > 0 ? static_cast<double>(bright) / static_cast<double>(count) : 0.0;
}
} // namespace bone
