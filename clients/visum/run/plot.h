// A check's course as SVG, with its limits: for the report.
#pragma once

#include <string>

#include "clients/visum/run/check.h"

namespace visum::run {

// Empty where the check was looked at fewer than twice.
std::string plot(const CheckResult& check);

}  // namespace visum::run
