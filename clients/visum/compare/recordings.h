// Compares two recordings tick by tick: where they part, and by how much each port differs. Any one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clients/visum/run/course.h"

namespace visum::compare {

// A port that is not the same in both.
struct PortDistance {
  std::string port;       // "arm/Actual Angle 1"
  std::int64_t tick = 0;  // the first at which it differs
  double a = 0.0, b = 0.0;
  double max_abs = 0.0;  // over all ticks that both have; infinity where one is no number
  std::int64_t max_tick = 0;
  double first_s = 0.0;            // simulated, since the beginning of the recordings: where it first differs
  run::Course course_a, course_b;  // its values by that time, over the ticks that both have
};

struct RecordingComparison {
  // All ticks, ports and hashes that both have, their number, and the files of the scene.
  bool equal = true;
  bool same_files = true;
  std::optional<std::int64_t> first_tick;  // the first that differs, or that one of them lacks
  std::uint64_t ticks_a = 0, ticks_b = 0;
  std::vector<PortDistance> ports;          // in the order of the world's parts
  std::vector<std::string> only_a, only_b;  // ports
  std::vector<std::string> settings;        // how the worlds were made differently: "engine: impulse, ode"
};

// Throws config::ConfigError where a file is no recording, or is damaged.
RecordingComparison compare_recordings(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace visum::compare
