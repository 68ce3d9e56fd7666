/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneChart.h"

#include "boneTicks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
constexpr int    MostTicks = 8;
constexpr double ChartMargin = 14.0;
const Color      ChartInk{ { 40, 40, 40 } };
const Color      GridLine{ { 222, 222, 222 } };
const TextStyle  TickStyle{ 11.0, ChartInk };
const TextStyle  LabelStyle{ 12.0, ChartInk };
const TextStyle  ChartTitle{ 14.0, ChartInk, TextAlign::Left, TextHeight::Baseline, true };

/** An axis with its range and ticks. */
struct Scale
{
  bool                log{ false };
  double              lower{ 0.0 };
  double              upper{ 1.0 };
  std::vector<double> ticks;

  /** 0 at the lower end, 1 at the upper; NaN where the axis has no place for the value. */
  double
  Share(double value) const
  {
    return log ? (value > 0.0 ? std::log(value / lower) / std::log(upper / lower) : std::nan(""))
               : (value - lower) / (upper - lower);
  }
};

/** A range of values that an axis can show: finite and, on a logarithmic one, positive. */
struct Range
{
  double lower{ std::numeric_limits<double>::max() };
  double upper{ std::numeric_limits<double>::lowest() };

  void
  Add(double value, bool log)
  {
    if (std::isfinite(value) && (!log || value > 0.0))
    {
      lower = std::min(lower, value);
      upper = std::max(upper, value);
    }
  }
};

/** The range grown to ticks, without those ends that are given. */
Scale
MakeScale(const ChartAxis & axis, Range range)
{
  Scale scale;
  scale.log = axis.log;
  range.Add(axis.lower.value_or(std::nan("")), axis.log);
  range.Add(axis.upper.value_or(std::nan("")), axis.log);
  if (range.lower > range.upper)
  {
    range = axis.log ? Range{ 1.0, 10.0 } : Range{ 0.0, 1.0 };
  }
  if (!(range.lower < range.upper))
  {
    const double room = axis.log ? 0.0 : std::max(0.5 * std::abs(range.lower), 1e-3);
    range = axis.log ? Range{ range.lower / 2.0, range.upper * 2.0 } : Range{ range.lower - room, range.upper + room };
  }
  scale.lower = axis.lower && (!axis.log || *axis.lower > 0.0) ? *axis.lower : range.lower;
  scale.upper = axis.upper && (!axis.log || *axis.upper > 0.0) ? *axis.upper : range.upper;
  if (!(scale.lower < scale.upper))
  {
    scale.lower = range.lower;
    scale.upper = range.upper;
  }
  if (!axis.log)
  {
    const double step = std::max(NiceStep((scale.upper - scale.lower) / (MostTicks - 2)), axis.whole ? 1.0 : 0.0);
    scale.lower = axis.lower ? scale.lower : step * std::floor(scale.lower / step + 1e-9);
    scale.upper = axis.upper ? scale.upper : step * std::ceil(scale.upper / step - 1e-9);
  }
  else
  {
    const double room = std::pow(scale.upper / scale.lower, 0.05);
    scale.lower = axis.lower ? scale.lower : scale.lower / room;
    scale.upper = axis.upper ? scale.upper : scale.upper * room;
  }
  scale.ticks =
    axis.log ? LogTicks(scale.lower, scale.upper, MostTicks + 2) : LinearTicks(scale.lower, scale.upper, MostTicks);
  if (axis.whole)
  {
    const auto part = [](double tick) { return std::abs(tick - std::round(tick)) > 1e-9; };
    scale.ticks.erase(std::remove_if(scale.ticks.begin(), scale.ticks.end(), part), scale.ticks.end());
  }
  return scale;
}

/** The axes on a canvas. */
struct Plot
{
  Scale     x;
  Scale     y;
  Rectangle area;

  Vector2
  At(const Vector2 & value) const
  {
    return { area.x + x.Share(value.x()) * area.width, area.y + (1.0 - y.Share(value.y())) * area.height };
  }
};

double
WidestTick(const Scale & scale)
{
  double widest = 0.0;
  for (const std::string & text : TickTexts(scale.ticks))
  {
    widest = std::max(widest, Canvas::MeasureText(text, TickStyle));
  }
  return widest;
}

/** Places legend entries in rows: the corner of each, and the height of all. */
struct LegendPlan
{
  std::vector<Vector2> corners;
  double               height{ 0.0 };
};

LegendPlan
PlanLegend(const std::vector<ChartSeries> & series, double width)
{
  constexpr double row = 18.0;
  LegendPlan       plan;
  double           x = 0.0;
  for (const ChartSeries & entry : series)
  {
    const double needs = 34.0 + Canvas::MeasureText(entry.name, TickStyle) + 16.0;
    const bool   shown = !entry.name.empty();
    if (shown && (plan.height == 0.0 || x + needs > width))
    {
      x = 0.0;
      plan.height += row;
    }
    plan.corners.emplace_back(x, plan.height - row);
    x += shown ? needs : 0.0;
  }
  return plan;
}

/** Area inside the axes' texts, below `head` pixels of title and legend. */
Rectangle
PlaceOf(const Scale & y, double width, double height, double head)
{
  Rectangle area;
  area.x = ChartMargin + 20.0 + WidestTick(y) + 8.0;
  area.y = ChartMargin + head;
  area.width = std::max(40.0, width - area.x - 1.6 * ChartMargin);
  area.height = std::max(40.0, height - area.y - 48.0);
  return area;
}

void
DrawAxes(Canvas & canvas, const Plot & plot, const std::string & xLabel, const std::string & yLabel)
{
  const Rectangle & area = plot.area;
  const double      bottom = area.y + area.height;
  TextStyle         style = TickStyle;
  style.align = TextAlign::Centre;
  style.height = TextHeight::Top;
  double     free = -std::numeric_limits<double>::max(); // where the last tick's number ends
  const auto xTexts = TickTexts(plot.x.ticks), yTexts = TickTexts(plot.y.ticks);
  for (std::size_t k = 0; k < xTexts.size(); ++k)
  {
    const double        x = area.x + plot.x.Share(plot.x.ticks[k]) * area.width;
    const std::string & text = xTexts[k];
    const double        half = 0.5 * Canvas::MeasureText(text, style);
    canvas.DrawLine({ x, area.y }, { x, bottom }, GridLine, 1.0);
    canvas.DrawLine({ x, bottom }, { x, bottom + 4.0 }, ChartInk, 1.0);
    if (x - half > free)
    {
      canvas.DrawText({ x, bottom + 8.0 }, text, style);
      free = x + half + 4.0;
    }
  }
  style.align = TextAlign::Right;
  style.height = TextHeight::Middle;
  for (std::size_t k = 0; k < yTexts.size(); ++k)
  {
    const double y = bottom - plot.y.Share(plot.y.ticks[k]) * area.height;
    canvas.DrawLine({ area.x, y }, { area.x + area.width, y }, GridLine, 1.0);
    canvas.DrawLine({ area.x - 4.0, y }, { area.x, y }, ChartInk, 1.0);
    canvas.DrawText({ area.x - 7.0, y }, yTexts[k], style);
  }
  canvas.DrawPolyline({ { area.x, area.y }, { area.x, bottom }, { area.x + area.width, bottom } }, ChartInk, 1.0);
  style = LabelStyle;
  style.align = TextAlign::Centre;
  canvas.DrawText({ area.x + 0.5 * area.width, bottom + 38.0 }, xLabel, style);
  style.upward = true;
  canvas.DrawText({ ChartMargin + 10.0, area.y + 0.5 * area.height }, yLabel, style);
}

void
DrawTitle(Canvas & canvas, const std::string & title)
{
  canvas.DrawText({ ChartMargin, ChartMargin + 12.0 }, title, ChartTitle);
}

double
TitleHeight(const std::string & title)
{
  return title.empty() ? 0.0 : 26.0;
}

void
DrawSeries(Canvas & canvas, const Plot & plot, const ChartSeries & series, const Color & color)
{
  std::vector<Vector2> line;
  const auto           flush = [&] {
    if (series.line)
    {
      canvas.DrawPolyline(line, color, 2.0, false, &plot.area);
    }
    line.clear();
  };
  for (const Vector2 & value : series.points)
  {
    const Vector2 p = plot.At(value);
    if (!p.allFinite())
    {
      flush();
      continue;
    }
    line.push_back(p);
    const double slack = 1e-6;
    const bool   inside = p.x() >= plot.area.x - slack && p.x() <= plot.area.x + plot.area.width + slack &&
                        p.y() >= plot.area.y - slack && p.y() <= plot.area.y + plot.area.height + slack;
    if (series.markers && inside)
    {
      canvas.FillCircle(p, 3.5, color);
    }
  }
  flush();
}
} // namespace

Canvas
DrawChart(const Chart & chart)
{
  Range x, y;
  for (const ChartSeries & series : chart.series)
  {
    for (const Vector2 & p : series.points)
    {
      x.Add(p.x(), chart.x.log);
      y.Add(p.y(), chart.y.log);
    }
  }
  Plot             plot{ MakeScale(chart.x, x), MakeScale(chart.y, y), {} };
  const double     title = TitleHeight(chart.title);
  const LegendPlan legend = PlanLegend(chart.series, chart.width - 2.0 * ChartMargin);
  plot.area = PlaceOf(plot.y, chart.width, chart.height, title + legend.height + 6.0);

  Canvas canvas(chart.width, chart.height);
  DrawTitle(canvas, chart.title);
  DrawAxes(canvas, plot, chart.x.label, chart.y.label);
  for (std::size_t k = 0; k < chart.series.size(); ++k)
  {
    const ChartSeries & series = chart.series[k];
    DrawSeries(canvas, plot, series, SeriesColor(k));
    if (!series.name.empty())
    {
      const Vector2 corner = legend.corners[k] + Vector2(ChartMargin, ChartMargin + title);
      const Vector2 end = corner + Vector2(26.0, 0.0);
      if (series.line)
      {
        canvas.DrawLine(corner, end, SeriesColor(k));
      }
      if (series.markers)
      {
        canvas.FillCircle(0.5 * (corner + end), 3.5, SeriesColor(k));
      }
      TextStyle style = TickStyle;
      style.height = TextHeight::Middle;
      canvas.DrawText(end + Vector2(8.0, 0.0), series.name, style);
    }
  }
  return canvas;
}

HistogramBins
CountBins(const Histogram & histogram)
{
  const double lowest = histogram.x.lower.value_or(-std::numeric_limits<double>::infinity());
  const double highest = histogram.x.upper.value_or(std::numeric_limits<double>::infinity());
  const auto   counts = [&](double v) { return std::isfinite(v) && v >= lowest && v <= highest; };
  Range        range;
  for (const double v : histogram.values)
  {
    range.Add(counts(v) ? v : std::nan(""), false);
  }
  HistogramBins bins;
  if (range.lower > range.upper)
  {
    return bins;
  }
  const double scale = std::max(std::abs(range.lower), std::abs(range.upper));
  // Values that are all alike fill one bin.
  const double extent = range.upper - range.lower;
  const double width = extent > 1e-3 * scale ? extent : scale > 0.0 ? 0.1 * scale : 1.0;
  const double step = NiceStep(width / std::max(1, histogram.bins - 1));
  const double first = std::floor(range.lower / step + 1e-9);
  const double last = std::max(first + 1.0, std::ceil(range.upper / step - 1e-9));
  for (double k = first; k <= last; k += 1.0)
  {
    bins.edges.push_back(k * step);
  }
  bins.counts.assign(bins.edges.size() - 1, 0);
  for (const double v : histogram.values)
  {
    if (counts(v))
    {
      const double k = std::floor(v / step + 1e-9) - first;
      ++bins.counts[static_cast<std::size_t>(std::clamp(k, 0.0, static_cast<double>(bins.counts.size() - 1)))];
    }
  }
  return bins;
}

Canvas
DrawHistogram(const Histogram & histogram)
{
  const HistogramBins bins = CountBins(histogram);
  Range               x, y;
  for (const double edge : bins.edges)
  {
    x.Add(edge, false);
  }
  ChartAxis xAxis = histogram.x;
  ChartAxis yAxis = histogram.y;
  xAxis.log = false;
  yAxis.lower = yAxis.lower.value_or(yAxis.log ? 0.5 : 0.0);
  for (const std::size_t count : bins.counts)
  {
    y.Add(static_cast<double>(count), yAxis.log);
  }
  Plot         plot{ MakeScale(xAxis, x), MakeScale(yAxis, y), {} };
  const double title = TitleHeight(histogram.title);
  plot.area = PlaceOf(plot.y, histogram.width, histogram.height, title + 6.0);

  Canvas canvas(histogram.width, histogram.height);
  DrawTitle(canvas, histogram.title);
  DrawAxes(canvas, plot, histogram.x.label, histogram.y.label);
  for (std::size_t k = 0; k < bins.counts.size(); ++k)
  {
    const double count = static_cast<double>(bins.counts[k]);
    const double height = std::clamp(count > 0.0 ? plot.y.Share(count) : 0.0, 0.0, 1.0) * plot.area.height;
    const double left = std::max(plot.At({ bins.edges[k], 1.0 }).x(), plot.area.x);
    const double right = std::min(plot.At({ bins.edges[k + 1], 1.0 }).x(), plot.area.x + plot.area.width);
    if (height > 0.0 && right > left)
    {
      const double gap = right - left > 4.0 ? 1.0 : 0.0;
      canvas.FillRectangle({ left, plot.area.y + plot.area.height - height, right - left - gap, height },
                           SeriesColor(0));
    }
  }
  return canvas;
}
} // namespace bone
