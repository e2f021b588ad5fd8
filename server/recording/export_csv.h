// A recording's ports as CSV (RFC 4180): a row per tick, a column per port.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

namespace visum::recording {

struct CsvOptions {
  std::vector<std::string> ports;  // PART, PART/GROUP or PART/PORT; none: all
  double from_s = 0.0;             // of simulated time
  double to_s = std::numeric_limits<double>::infinity();
  std::int64_t every = 1;  // ticks
};

struct CsvResult {
  std::uint64_t rows = 0;
  std::string damage;  // why the file was not read to its end; empty: it was
};

// Throws ConfigError where the file is no recording, std::runtime_error where it has no port of a name that
// is asked for.
CsvResult export_csv(const std::filesystem::path& file, const CsvOptions& options, std::ostream& out);

}  // namespace visum::recording
