#include "server/gateway/beside.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/config/config.h"
#include "protocol/json_text.h"
#include "server/world/world_state.h"

namespace visum::gateway {
namespace {

using protocol::json_quoted;

constexpr std::size_t kListedPorts = 20;
constexpr std::size_t kListedTexts = 20;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// 0 for the same orientation, rad.
double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const double chord =
      std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm());  // q and -q are the same
  return 4.0 * std::asin(std::min(1.0, chord / 2.0));
}

std::string texts_as_json(const std::vector<std::string>& texts) {
  std::string list;
  for (std::size_t i = 0; i < std::min(texts.size(), kListedTexts); ++i)
    list += (i == 0 ? "" : ",") + json_quoted(texts[i]);
  return "[" + list + "]";
}

std::map<std::string, std::size_t> columns_of(const protocol::PartDescription& part) {
  std::map<std::string, std::size_t> columns;
  std::size_t column = 1;  // after the time
  for (const auto* ports : {&part.controller_inputs, &part.sensor_outputs})
    for (const auto& port : *ports) columns.emplace(port.name, column++);
  return columns;
}

}  // namespace

Beside::Beside(const std::filesystem::path& a, const std::filesystem::path& b,
               const recording::PluginFolders& plugins)
    : file_name_(b.filename().string()),
      pair_(a, b),
      player_(b, plugins, recording::without_real_time),
      ports_(b, player_.points()) {
  for (const auto& bound : std::as_const(player_.world()).parts())
    columns_[bound.part->description().name] = columns_of(bound.part->description());
}

bool Beside::compare() {
  if (over_) return false;
  try {
    over_ = !pair_.next();
  } catch (const config::ConfigError& error) {
    damage_ = error.what();
    over_ = true;
  }
  return !over_;
}

std::string Beside::ports_as_json() const {
  std::vector<const recording::RecordingPair::Port*> differing;
  for (const auto& port : pair_.ports())
    if (port.first) differing.push_back(&port);
  std::ranges::stable_sort(differing, {}, [](const auto* port) { return port->first->position; });
  std::string list;
  for (std::size_t i = 0; i < std::min(differing.size(), kListedPorts); ++i) {
    const auto& port = *differing[i];
    list += (i == 0 ? "" : ",") + std::string("{\"part\":") + json_quoted(port.part) +
            ",\"port\":" + json_quoted(port.name) + ",\"position\":" + std::to_string(port.first->position) +
            ",\"tick\":" + std::to_string(port.first->tick) +
            ",\"a\":" + json_quoted(protocol::exact_number(port.first_a)) +
            ",\"b\":" + json_quoted(protocol::exact_number(port.first_b)) +
            ",\"max_abs\":" + json_quoted(protocol::exact_number(port.max_abs)) +
            ",\"max_tick\":" + std::to_string(port.max_tick) + "}";
  }
  return "\"ports\":[" + list + "],\"port_count\":" + std::to_string(differing.size());
}

std::string Beside::report() const {
  std::string json =
      "{\"file\":" + json_quoted(file_name_) + ",\"ticks\":" + std::to_string(player_.ticks()) +
      ",\"compared\":" + std::to_string(std::max(pair_.ticks_a(), pair_.ticks_b())) +
      ",\"over\":" + (over_ ? "true" : "false") + ",\"damage\":" + json_quoted(damage_) +
      ",\"settings\":" + texts_as_json(pair_.settings()) + ",\"only_a\":" + texts_as_json(pair_.only_a()) +
      ",\"only_b\":" + texts_as_json(pair_.only_b()) + "," + ports_as_json();
  if (const auto& first = pair_.first())
    json += ",\"first\":{\"position\":" + std::to_string(first->position) +
            ",\"tick\":" + std::to_string(first->tick) + "}";
  return json + "}";
}

std::span<const double> Beside::bodies(const cycle::Simulation& a, std::uint64_t position) {
  player_.seek(position);
  const auto& b = std::as_const(player_).world();
  bodies_ = {static_cast<double>(position), static_cast<double>(a.sim_time_ns()) / 1e9};
  for (std::size_t i = 0; i < a.model().bodies.size(); ++i) {
    const auto& body = a.model().bodies[i];
    const auto in_b = b.model().find_body(body.name);
    if (!in_b.valid()) {
      bodies_.insert(bodies_.end(), 9, kUnknown);
      continue;
    }
    const auto X_WA = world::link_pose(body, a.state().bodies[i]);
    const auto X_WB = world::link_pose(b.model().bodies[in_b.index()], b.state().bodies[in_b.index()]);
    bodies_.insert(bodies_.end(), {X_WB.p.x(), X_WB.p.y(), X_WB.p.z(), X_WB.q.w(), X_WB.q.x(), X_WB.q.y(),
                                   X_WB.q.z(), (X_WB.p - X_WA.p).norm(), angle_between(X_WA.q, X_WB.q)});
  }
  return bodies_;
}

std::vector<double> Beside::ports(const protocol::PartDescription& part, const recording::PortReader::Rows& a,
                                  std::uint64_t to, std::uint64_t count) {
  const auto found = columns_.find(part.name);
  if (found == columns_.end() || a.positions.empty()) return {};
  std::vector<std::size_t> columns;  // of B, by column of A after the time; 0: B does not have it
  for (const auto* ports : {&part.controller_inputs, &part.sensor_outputs})
    for (const auto& port : *ports) {
      const auto column = found->second.find(port.name);
      columns.push_back(column == found->second.end() ? 0 : column->second);
    }
  // Stretches of the same ticks: where B ends sooner, fewer.
  const auto from = to - std::min(to, count);
  const auto end = std::min(to, player_.ticks());
  if (end <= from) return {};
  const auto b = ports_.read(part.name, end, end - from);
  if (b.positions.empty()) return {};
  const auto width_a = a.values.size() / a.positions.size(), width_b = b.values.size() / b.positions.size();
  std::vector<double> rows;
  std::size_t in_b = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    while (in_b < b.positions.size() && b.positions[in_b] < a.positions[i]) ++in_b;
    if (in_b == b.positions.size()) break;
    if (b.positions[in_b] != a.positions[i]) continue;
    rows.push_back(a.values[i * width_a]);
    for (const auto column : columns)
      rows.push_back(column == 0 || column >= width_b ? kUnknown : b.values[in_b * width_b + column]);
  }
  return rows;
}

}  // namespace visum::gateway
