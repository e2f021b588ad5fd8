// Tells whether a measured value is inside its bounds, and how far. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "clients/visum/run/scenario.h"

namespace visum::run {

// The distance to the nearest bound: >= 0 inside, < 0 outside. NaN is infinitely far outside. The value that
// comes nearest to breaking a bound has the smallest margin.
double margin(const Bounds& bounds, double value);
bool holds(const Bounds& bounds, double value);
std::vector<double> limits(const Bounds& bounds);                    // the edges of the range, for plots
std::string to_text(const Bounds& bounds, const std::string& unit);  // "below 0.01 m"

}  // namespace visum::run
