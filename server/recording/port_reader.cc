#include "server/recording/port_reader.h"

#include <algorithm>
#include <utility>

namespace visum::recording {

PortReader::PortReader(const std::filesystem::path& file, std::vector<StatePoint> points)
    : file_(file), beginning_(file_.place()), points_(std::move(points)) {
  // All channels stand at the beginning, each before its part's description (beginning.cc). Messages further
  // on mean nothing to a reader that has not met their channels.
  while (std::holds_alternative<const protocol::PartDescription*>(file_.next())) {
  }
}

PortReader::Rows PortReader::read(const std::string& part, std::uint64_t to, std::uint64_t count) {
  const auto from = to - std::min(to, count);
  const auto after = std::ranges::upper_bound(points_, from, {}, &StatePoint::position);
  const bool at_beginning = after == points_.begin();
  auto position = at_beginning ? 0 : (after - 1)->position;
  file_.go_to(at_beginning ? beginning_ : (after - 1)->place);
  Rows rows;
  protocol::PartSample sample;
  std::uint64_t era = 0;
  while (position < to) {
    const auto item = file_.next();
    if (std::holds_alternative<RecordingFile::End>(item)) break;
    const auto* of_part = std::get_if<const protocol::PartSample*>(&item);
    if (of_part && (*of_part)->part == part) sample = **of_part;
    if (!std::holds_alternative<const Tick*>(item) || ++position <= from) continue;
    if (std::exchange(sample.part, {}).empty()) continue;  // it was not there in this tick
    if (std::exchange(era, sample.era) != sample.era) rows = {};
    rows.positions.push_back(position);
    auto& values = rows.values;
    values.push_back(static_cast<double>(sample.sim_time_ns) / 1e9);
    values.insert(values.end(), sample.controller_inputs.begin(), sample.controller_inputs.end());
    values.insert(values.end(), sample.sensor_outputs.begin(), sample.sensor_outputs.end());
  }
  return rows;
}

}  // namespace visum::recording
