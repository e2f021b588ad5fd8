// The report as JUnit XML: a suite per run, in it a test case per check and controller and one for the run as
// a whole, figures as properties.
#pragma once

#include <span>
#include <string>

#include "clients/visum/run/report.h"

namespace visum::run {

std::string report_junit(const Report& report);
std::string report_junit(std::span<const Report> reports);

}  // namespace visum::run
