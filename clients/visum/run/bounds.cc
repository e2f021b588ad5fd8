#include "clients/visum/run/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "clients/visum/common/format.h"

namespace visum::run {

double margin(const Bounds& bounds, double value) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (std::isnan(value)) return -kInfinity;
  double least = kInfinity;
  if (bounds.below) least = std::min(least, *bounds.below - value);
  if (bounds.above) least = std::min(least, value - *bounds.above);
  if (bounds.between)
    least = std::min({least, value - bounds.between->first, bounds.between->second - value});
  if (bounds.equals) least = std::min(least, bounds.within - std::abs(value - *bounds.equals));
  return least;
}

bool holds(const Bounds& bounds, double value) {
  if (bounds.below && !(value < *bounds.below)) return false;
  if (bounds.above && !(value > *bounds.above)) return false;
  return margin(bounds, value) >= 0.0;
}

std::vector<double> limits(const Bounds& bounds) {
  std::vector<double> limits;
  if (bounds.below) limits.push_back(*bounds.below);
  if (bounds.above) limits.push_back(*bounds.above);
  if (bounds.between) limits.insert(limits.end(), {bounds.between->first, bounds.between->second});
  if (bounds.equals) limits.push_back(*bounds.equals - bounds.within);
  if (bounds.equals && bounds.within > 0.0) limits.push_back(*bounds.equals + bounds.within);
  return limits;
}

std::string to_text(const Bounds& bounds, const std::string& unit) {
  std::string text;
  const auto add = [&](const std::string& bound) { text += (text.empty() ? "" : " and ") + bound; };
  if (bounds.below) add("below " + cli::exact(*bounds.below));
  if (bounds.above) add("above " + cli::exact(*bounds.above));
  if (bounds.between) {
    add("within " + cli::exact(bounds.between->first) + " .. " + cli::exact(bounds.between->second));
  }
  if (bounds.equals) add("equal to " + cli::exact(*bounds.equals));
  if (bounds.equals && bounds.within > 0.0) text += " within " + cli::exact(bounds.within);
  return unit.empty() ? text : text + " " + unit;
}

}  // namespace visum::run
