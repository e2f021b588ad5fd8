// Writes a recording's ports as CSV (RFC 4180): a row per tick, a column per port. Parts of models that were
// spawned have columns, too; their cells are empty while the part is not there. Any one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

namespace visum::recording {

struct CsvOptions {
  std::vector<std::string> ports;  // PART, PART/GROUP or PART/PORT; empty: all ports
  double from_s = 0.0;             // of simulated time
  double to_s = std::numeric_limits<double>::infinity();
  std::int64_t every = 1;  // in ticks: 10 writes every tenth
};

struct CsvResult {
  std::uint64_t rows = 0;
  std::string damage;  // why the file was not read to its end; empty: it was
};

// Reads the file twice. Throws ConfigError where it is no recording, and std::runtime_error where it lacks
// ports that `options` names, or has more than 100,000 wanted ones.
CsvResult export_csv(const std::filesystem::path& file, const CsvOptions& options, std::ostream& out);

}  // namespace visum::recording
