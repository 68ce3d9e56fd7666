/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTicks.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace bone
{
namespace
{
constexpr double Rounding = 1e-9; // relative

bool
IsRange(double lower, double upper)
{
  return std::isfinite(lower) && std::isfinite(upper) && lower < upper;
}
} // namespace

double
NiceLength(double most)
{
  if (!(most > 0.0 && std::isfinite(most)))
  {
    return 0.0;
  }
  const double power = std::pow(10.0, std::floor(std::log10(most) + Rounding));
  const double times = most / power * (1.0 + Rounding);
  return (times >= 5.0 ? 5.0 : times >= 2.0 ? 2.0 : 1.0) * power;
}

double
NiceStep(double least)
{
  if (!(least > 0.0 && std::isfinite(least)))
  {
    return 0.0;
  }
  const double power = std::pow(10.0, std::floor(std::log10(least) + Rounding));
  const double times = least / power * (1.0 - Rounding);
  return (times <= 1.0 ? 1.0 : times <= 2.0 ? 2.0 : times <= 5.0 ? 5.0 : 10.0) * power;
}

std::vector<double>
LinearTicks(double lower, double upper, int most)
{
  std::vector<double> ticks;
  if (!IsRange(lower, upper) || most < 2)
  {
    return ticks;
  }
  const double step = NiceStep((upper - lower) / (most - 1));
  const double slack = Rounding * (upper - lower) / step;
  for (double k = std::ceil(lower / step - slack); k <= std::floor(upper / step + slack); k += 1.0)
  {
    ticks.push_back(k == 0.0 ? 0.0 : k * step);
  }
  return ticks;
}

std::vector<double>
LogTicks(double lower, double upper, int most)
{
  std::vector<double> ticks;
  if (!IsRange(lower, upper) || !(lower > 0.0) || most < 1)
  {
    return ticks;
  }
  const double first = std::ceil(std::log10(lower) - Rounding);
  const double last = std::floor(std::log10(upper) + Rounding);
  for (double k = first - 1.0; k <= last; k += 1.0)
  {
    for (const double times : { 1.0, 2.0, 5.0 })
    {
      const double tick = times * std::pow(10.0, k);
      if (tick >= lower * (1.0 - Rounding) && tick <= upper * (1.0 + Rounding))
      {
        ticks.push_back(tick);
      }
    }
  }
  if (ticks.size() > static_cast<std::size_t>(most))
  {
    ticks.clear();
    const double every = std::max(1.0, std::ceil((last - first + 1.0) / most));
    for (double k = first; k <= last; k += every)
    {
      ticks.push_back(std::pow(10.0, k));
    }
  }
  return ticks;
}

double
RoundInRange(double value, double range)
{
  const double step = NiceLength(0.02 * range);
  return step > 0.0 ? step * std::round(value / step) : value;
}

std::string
TickText(double value, int digits)
{
  std::ostringstream text;
  text.precision(std::abs(value) < 1e6 && std::abs(value) >= 1e4 ? std::max(6, digits) : digits);
  text << value;
  return text.str();
}

std::vector<std::string>
TickTexts(const std::vector<double> & ticks)
{
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : 0.0;
  int          digits = 4;
  const auto isRounded = [&](double tick) { return std::abs(std::stod(TickText(tick, digits)) - tick) > 0.01 * step; };
  while (step > 0.0 && digits < 15 && std::any_of(ticks.begin(), ticks.end(), isRounded))
  {
    ++digits;
  }
  std::vector<std::string> texts;
  for (const double tick : ticks)
  {
    texts.push_back(TickText(tick, digits));
  }
  return texts;
}
} // namespace bone
