// The output of `visumd export`: the ports of a recording as a CSV file.
#pragma once

#include <string>

#include "server/recording/export_csv.h"

namespace visum::programs {

// Writes to the file `to`, or to standard output where that is empty. Returns the exit code: kPassed, or
// kFailed if the recording is damaged and what can be read of it is written. Throws std::runtime_error where
// the file cannot be written, and what recording::export_csv throws; no half file is left then.
int export_ports(const std::string& file, const recording::CsvOptions& options, const std::string& to);

}  // namespace visum::programs
