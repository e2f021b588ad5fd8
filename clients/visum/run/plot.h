// Draws a check's values over time as SVG, with its limits, for the HTML report.
#pragma once

#include <string>

#include "clients/visum/run/check.h"

namespace visum::run {

// Empty if the check has fewer than two points.
std::string plot(const CheckResult& check);

}  // namespace visum::run
