#include "clients/visum/compare/recordings.h"

#include <utility>

#include "protocol/recording/recording_pair.h"

namespace visum::compare {

RecordingComparison compare_recordings(const std::filesystem::path& a, const std::filesystem::path& b) {
  recording::RecordingPair pair(a, b);
  std::vector<run::Course> courses_a, courses_b;  // by port
  while (pair.next()) {
    if (!pair.both()) continue;
    courses_a.resize(pair.ports().size());
    courses_b.resize(pair.ports().size());
    const double at_s = pair.seconds(pair.ticks_a());
    for (std::size_t i = 0; i < pair.ports().size(); ++i) {
      courses_a[i].add(at_s, pair.ports()[i].a);
      courses_b[i].add(at_s, pair.ports()[i].b);
    }
  }
  RecordingComparison result;
  if (pair.first()) result.first_tick = pair.first()->tick;
  result.ticks_a = pair.ticks_a();
  result.ticks_b = pair.ticks_b();
  result.only_a = pair.only_a();
  result.only_b = pair.only_b();
  result.settings = pair.settings();
  result.same_files = pair.same_files();
  result.equal = !result.first_tick && result.only_a.empty() && result.only_b.empty() && result.same_files;
  for (std::size_t i = 0; i < pair.ports().size(); ++i) {
    const auto& port = pair.ports()[i];
    if (!port.first) continue;
    result.ports.push_back({.port = port.part + "/" + port.name,
                            .tick = port.first->tick,
                            .a = port.first_a,
                            .b = port.first_b,
                            .max_abs = port.max_abs,
                            .max_tick = port.max_tick,
                            .first_s = pair.seconds(port.first->position),
                            .course_a = std::move(courses_a[i]),
                            .course_b = std::move(courses_b[i])});
  }
  return result;
}

}  // namespace visum::compare
