/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneChart_h
#define boneChart_h

#include "boneCanvas.h"

#include <optional>
#include <string>
#include <vector>

namespace bone
{
/** An axis of a chart. */
struct ChartAxis
{
  std::string           label; ///< with its unit: "error (HU)"
  bool                  log{ false };
  bool                  whole{ false }; ///< ticks at whole numbers alone: degrees, levels, modes
  std::optional<double> lower;          ///< default: that of the data, or the tick below
  std::optional<double> upper;          ///< default: that of the data, or the tick above
};

/** Points of a chart that belong together. */
struct ChartSeries
{
  std::string          name;   ///< in the legend; empty: not there
  std::vector<Vector2> points; ///< joined by a line in this order; one that is not finite interrupts it
  bool                 line{ true };
  bool                 markers{ true };
};

/** A chart of lines; points that are not positive are left out on a logarithmic axis. */
struct Chart
{
  std::string              title;
  ChartAxis                x;
  ChartAxis                y;
  std::vector<ChartSeries> series;
  double                   width{ 560.0 }; ///< pixels
  double                   height{ 360.0 };
};

/** Numbers of values in bins of a 1-2-5 width. */
struct Histogram
{
  std::string         title;
  ChartAxis           x;              ///< not logarithmic
  ChartAxis           y;              ///< counts
  std::vector<double> values;         ///< those that are not finite or out of the x axis' range are left out
  int                 bins{ 40 };     ///< at most
  double              width{ 560.0 }; ///< pixels
  double              height{ 300.0 };
};

/** Counts of a histogram: bin k is edges[k]..edges[k + 1], its upper end excluded but in the last. */
struct HistogramBins
{
  std::vector<double>      edges;
  std::vector<std::size_t> counts;
};

/** The bins of a histogram; none where no value is counted. */
HistogramBins
CountBins(const Histogram & histogram);

/** Lines with markers over axes with 1-2-5 ticks; the colours are those of \ref SeriesColor, the legend names the
 * series. */
Canvas
DrawChart(const Chart & chart);

Canvas
DrawHistogram(const Histogram & histogram);
} // namespace bone

#endif
