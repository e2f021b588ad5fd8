// Whether a measured value is inside its bounds, and how far.
#pragma once

#include <string>
#include <vector>

#include "clients/visum/run/scenario.h"

namespace visum::run {

// How far inside (>= 0) or outside (< 0) the value is; NaN is infinitely far outside. The value that is
// nearest to breaking a bound has the smallest margin.
double margin(const Bounds& bounds, double value);
bool holds(const Bounds& bounds, double value);
std::vector<double> limits(const Bounds& bounds);                    // the values at its edges
std::string to_text(const Bounds& bounds, const std::string& unit);  // "below 0.01 m"

}  // namespace visum::run
