// The report as JUnit XML: a test case per check and controller, one for the run as a whole, figures as
// properties.
#pragma once

#include <string>

#include "clients/visum/run/report.h"

namespace visum::run {

std::string report_junit(const Report& report);

}  // namespace visum::run
