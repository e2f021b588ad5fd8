#include "server/gateway/playback.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "protocol/json_text.h"
#include "server/gateway/idle_part.h"
#include "server/recording/build.h"
#include "server/scene/scene.h"

namespace visum::gateway {
namespace {

constexpr const char *kPosition = "Position", *kKind = "recording";
constexpr double kMostTicks = 1e15;
constexpr std::string_view kPortsPath = "/recording/ports/", kBesidePath = "/recording/beside/ports/";
constexpr std::uint64_t kMostRows = 10'000;        // at once
constexpr std::size_t kLongestReport = 64u << 10;  // bytes
constexpr std::size_t kReport = 0;                 // the other blackboard is that of the bodies of B
constexpr std::size_t kMostNumbers = 1u << 20;     // in that one

// Shown in real time, whatever clock it was recorded with. Viewers may pause it and change its speed.
void in_real_time(scene::Scene& scene) {
  scene.clock = scene::ClockKind::kRealtime;
  scene.speed = 1.0;
}

std::string free_name(const cycle::Simulation& world) {
  std::string name = kKind;
  const auto is_taken = [&](const auto& bound) { return bound.part->description().name == name; };
  while (std::ranges::any_of(world.parts(), is_taken)) name += "_";
  return name;
}

std::string ports_as_json(const std::vector<recording::PortDifference>& ports) {
  std::string list;
  for (const auto& port : ports)
    list += (list.empty() ? "" : ",") + std::string("{\"part\":") + protocol::json_quoted(port.part) +
            ",\"port\":" + protocol::json_quoted(port.port) +
            ",\"recorded\":" + protocol::json_quoted(protocol::exact_number(port.recorded)) +
            ",\"replayed\":" + protocol::json_quoted(protocol::exact_number(port.replayed)) + "}";
  return "[" + list + "]";
}

std::string events_as_json(const recording::EventList& list) {
  std::string events;
  for (const auto& [position, event] : list.events())
    events += (events.empty() ? "" : ",") + std::string("{\"position\":") + std::to_string(position) +
              ",\"era\":" + std::to_string(event.era) + ",\"tick\":" + std::to_string(event.tick) +
              ",\"time_ns\":" + std::to_string(event.sim_time_ns) + ",\"level\":\"" +
              protocol::to_string(event.level) + "\",\"kind\":" + protocol::json_quoted(event.kind) +
              ",\"part\":" + protocol::json_quoted(event.part) +
              ",\"text\":" + protocol::json_quoted(event.text) + "}";
  return "{\"left_out\":" + std::to_string(list.left_out()) + ",\"events\":[" + events + "]}";
}

}  // namespace

// The part that steers. It does not belong to the world.
class Playback::Steering : public IdlePart {
 public:
  explicit Steering(Playback& playback) : playback_(playback) {
    description_.name = playback.name();
    description_.kind = kKind;
    description_.sensor_outputs = {{kPosition, "", 0.0, kMostTicks, 0.0, kPosition}};
    description_.parameters = parameters();
    description_.blackboards = {{"Report", "application/json", 1, 0, kLongestReport, false}};
    if (playback_.beside_)
      description_.blackboards.push_back(
          {"Beside", "application/x-float64", sizeof(double), 0, kMostNumbers, false});
  }
  const protocol::PartDescription& description() const override { return description_; }

  std::vector<protocol::Parameter> parameters() const override {
    protocol::Parameter position;
    position.name = kPosition;
    position.help = "ticks since the recording's beginning";
    position.value = static_cast<std::int64_t>(playback_.player_.position());
    position.maximum = static_cast<double>(playback_.player_.ticks());
    return {position};
  }
  std::optional<std::string> set_parameter(const std::string& name,
                                           const protocol::ParameterValue& value) override {
    const auto* position = std::get_if<std::int64_t>(&value);
    if (name != kPosition || !position) return "'" + name + "' takes a whole number";
    const auto ticks = playback_.player_.ticks();
    if (*position < 0 || static_cast<std::uint64_t>(*position) > ticks)
      return "the recording has the positions 0 to " + std::to_string(ticks);
    playback_.seek(static_cast<std::uint64_t>(*position));
    return {};
  }
  std::span<const std::byte> read_blackboard(std::size_t index) const override {
    if (index != kReport)
      return std::as_bytes(playback_.beside_->bodies(playback_.world(), playback_.player_.position()));
    report_ = playback_.report();
    return std::as_bytes(std::span(report_));
  }

 private:
  Playback& playback_;
  protocol::PartDescription description_;
  mutable std::string report_;
};

Playback::Playback(const std::filesystem::path& file, const recording::PluginFolders& plugins,
                   const std::filesystem::path& beside)
    : file_(file),
      beside_(beside.empty() ? nullptr : std::make_unique<Beside>(file, beside, plugins)),
      player_(file, plugins, in_real_time),
      comparison_(file, plugins),
      ports_(file, player_.points()),
      events_(events_as_json(player_.events())),
      name_(free_name(player_.world())),
      recorded_era_(player_.world().era()),
      shown_revision_(player_.world().revision()) {
  for (const auto& bound : std::as_const(player_.world()).parts())
    parts_.push_back(bound.part->description());
  player_.world().add_onlooker(std::make_unique<Steering>(*this));
}

void Playback::seek(std::uint64_t position) {
  ++jumps_;
  player_.seek(position);
}

bool Playback::compare() {
  return (beside_ && beside_->compare()) || comparison_.run(1);
}

std::optional<std::string> Playback::ports_at(const std::string& path) {
  const bool of_b = beside_ && path.starts_with(kBesidePath);
  if (!of_b && !path.starts_with(kPortsPath)) return {};
  std::istringstream words(path.substr((of_b ? kBesidePath : kPortsPath).size()));
  std::uint64_t part = 0, to = 0, count = 0;
  char between = 0;
  words >> part >> between >> to >> between >> count;
  if (!words || !words.eof() || part >= parts_.size()) return {};
  to = std::min(to, player_.ticks());
  count = std::min(count, kMostRows);
  auto rows = ports_.read(parts_[part].name, to, count);
  if (of_b) rows.values = beside_->ports(parts_[part], rows, to, count);
  const auto bytes = std::as_bytes(std::span(rows.values));
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::string Playback::report() const {
  const auto& found = comparison_.result();
  std::string json = "{\"file\":" + protocol::json_quoted(file_.filename().string()) +
                     ",\"ticks\":" + std::to_string(player_.ticks()) +
                     ",\"tick_ns\":" + std::to_string(player_.header().tick_ns) +
                     ",\"position\":" + std::to_string(player_.position()) +
                     ",\"compared\":" + std::to_string(found.ticks) +
                     ",\"equal\":" + (found.equal ? "true" : "false") +
                     ",\"damage\":" + protocol::json_quoted(player_.damage());
  if (!found.equal) {
    const auto other = recording::difference(found.header.build, recording::this_build({}));
    json += ",\"difference\":{\"position\":" + std::to_string(std::min(found.ticks + 1, player_.ticks())) +
            ",\"tick\":" + std::to_string(found.difference.tick) +
            ",\"era\":" + std::to_string(found.difference.era) +
            ",\"what\":" + protocol::json_quoted(found.difference.what) +
            ",\"other_build\":" + protocol::json_quoted(other) +
            ",\"ports\":" + ports_as_json(found.difference.ports) + "}";
  }
  if (beside_) json += ",\"beside\":" + beside_->report();
  return json + "}";
}

void Playback::show_ports(Published& published) const {
  const auto parts = player_.world().parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto& name = parts[i].part->description().name;
    auto& shown = published.parts[published.table->slot_of[i]];
    if (name == name_) shown.sensor_outputs = {static_cast<double>(player_.position())};
    const auto* sample = player_.sample(name);
    if (!sample || sample->controller_inputs.size() != shown.controller_inputs.size() ||
        sample->sensor_outputs.size() != shown.sensor_outputs.size())
      continue;
    shown.controller_inputs = sample->controller_inputs;
    shown.sensor_outputs = sample->sensor_outputs;
  }
}

// For clients, time must never go back within an era. So a jump begins a new era, as a recorded reset does.
std::uint64_t Playback::era() {
  const auto recorded = player_.world().era();
  if (std::exchange(jumps_, 0) > 0 || recorded != recorded_era_) ++shown_era_;
  recorded_era_ = recorded;
  return shown_era_;
}

void Playback::show(Published& published) {
  const auto& world = player_.world();
  published.era = era();
  if (std::exchange(shown_revision_, world.revision()) != world.revision())
    view_ = std::make_shared<const WorldView>(describe_world(world.scene(), world.revision()));
  published.shown = view_;
  show_ports(published);
}

}  // namespace visum::gateway
