// A report as a file, and back: how the processes of a sweep tell what they found. JSON, which is YAML too.
#pragma once

#include <filesystem>
#include <string>

#include "clients/visum/run/report.h"

namespace visum::run {

// Everything that a report holds, numbers to the bit; NaN and infinity become null.
std::string report_as_json(const Report& report);

// Throws config::ConfigError for what is no such file, or cut short.
Report read_report(const std::filesystem::path& file);

}  // namespace visum::run
