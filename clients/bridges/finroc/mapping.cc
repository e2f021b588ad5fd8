#include "clients/bridges/finroc/mapping.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "protocol/part_description.h"

namespace visum::finroc {
namespace {

constexpr std::chrono::milliseconds kSettingsEvery{500};
constexpr std::size_t kMostShownBytes = 16u << 10;  // of a blackboard; the rest is not shown
constexpr std::size_t kMostChoices = 256;

Type a_text() {
  return {Kind::kText, "String", {}};
}

std::int64_t wall_time_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

Type type_of(const std::string& part, const ParameterInfo& parameter) {
  if (std::holds_alternative<bool>(parameter.value)) return {Kind::kBool, "bool", {}};
  if (!std::holds_alternative<std::string>(parameter.value)) return number_type();
  const auto& choices = parameter.choices;
  if (choices.empty() || choices.size() > kMostChoices) return a_text();
  if (std::find(choices.begin(), choices.end(), std::get<std::string>(parameter.value)) == choices.end())
    return a_text();
  return {Kind::kChoice, part + " " + parameter.name, choices};
}

Value to_board(const Type& type, const ParameterValue& value) {
  if (type.kind == Kind::kChoice) {
    const auto found = std::find(type.choices.begin(), type.choices.end(), std::get<std::string>(value));
    return static_cast<std::int64_t>(found == type.choices.end() ? 0 : found - type.choices.begin());
  }
  return std::visit([](const auto& content) { return Value(content); }, value);
}

double as_double(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* on = std::get_if<bool>(&value)) return *on ? 1.0 : 0.0;
  return std::get<double>(value);
}

// The type of a parameter is known by the value that it has.
ParameterValue to_server(const Element& element, const Value& value) {
  if (element.type.kind == Kind::kChoice) return in_text(element.type, value);
  if (element.type.kind == Kind::kBool) return std::get<bool>(value);
  if (element.type.kind == Kind::kText) return std::get<std::string>(value);
  const auto* whole = std::get_if<std::int64_t>(&value);
  if (std::holds_alternative<double>(element.value)) return as_double(value);
  if (whole != nullptr) return *whole;
  const double given = std::get<double>(value);
  const bool is_whole = given == static_cast<double>(static_cast<std::int64_t>(
                                     std::clamp(given, -9e15, 9e15)));  // beyond these it is refused below
  if (is_whole) return static_cast<std::int64_t>(given);
  return given;  // the server refuses it with the reason
}

std::string shown(const BlackboardInfo& board, const std::vector<std::byte>& data) {
  const std::size_t size = std::min(data.size(), kMostShownBytes);
  if (board.content_type.starts_with("text/") || board.content_type.ends_with("json")) {
    return {reinterpret_cast<const char*>(data.data()), size};
  }
  return board.content_type + ", " + std::to_string(data.size()) + " bytes";
}

}  // namespace

Mapping::Mapping(bridge::Plant& plant, Board& board, bridge::Cycle* cycle)
    : plant_(plant),
      board_(board),
      cycle_(cycle),
      controllers_(plant, board, [this](const auto& part, auto vector, std::size_t index) {
        return find_port(part, vector, index);
      }) {
  board_.now_ns = wall_time_ns();
  const ElementId runtime = board_.add_plain(kRoot, "Runtime");
  board_.add_administration(board_.add_plain(runtime, "Services"), "Administration");
  const std::string& scene_name = plant_.client().server().scene;
  const ElementId scene = board_.add_group(kRoot, scene_name.empty() ? "Visum" : scene_name);
  for (std::size_t part = 0; part < plant_.parts().size(); ++part) add_part(scene, part);
  const ElementId module = board_.add_module(scene, "Bridge");
  if (cycle_ != nullptr) {
    const ElementId inputs = board_.add_interface(module, "Controller Input", flag::kControllerData);
    step_ = board_.add_port(inputs, "Step", number_type(), Access::kWrite, std::int64_t{0});
  }
  const ElementId outputs = board_.add_interface(module, "Sensor Output", flag::kSensorData);
  time_ = board_.add_port(outputs, "Simulated Time", number_type(), Access::kRead, 0.0, unit_code("s"));
  last_refusal_ = board_.add_port(outputs, "Last Refusal", a_text(), Access::kRead, std::string());
  refusals_ = board_.add_port(outputs, "Refusals", number_type(), Access::kRead, std::int64_t{0});
  board_.write = [this](ElementId id, const Value& value, const std::string& peer) {
    return write(id, value, peer);
  };
}

std::optional<ElementId> Mapping::find_port(const std::string& part, protocol::ModuleVector vector,
                                            std::size_t index) const {
  const bool input = vector == protocol::ModuleVector::kControllerInput;
  for (const auto& [id, link] : links_) {
    if (link.source != (input ? Source::kInput : Source::kOutput) || link.index != index) continue;
    if (plant_.parts()[link.part].name() == part) return id;
  }
  return {};
}

void Mapping::add_part(ElementId scene, std::size_t part) {
  const ElementId module = board_.add_module(scene, plant_.parts()[part].name());
  add_ports(module, part, Source::kInput);
  add_ports(module, part, Source::kOutput);
  add_parameters(module, part);
  add_blackboards(module, part);
}

void Mapping::add_ports(ElementId module, std::size_t part, Source source) {
  const Part& described = plant_.parts()[part];
  const bool inputs = source == Source::kInput;
  const auto& ports = inputs ? described.input_ports() : described.output_ports();
  if (ports.empty()) return;
  const ElementId interface = inputs ? board_.add_interface(module, "Controller Input", flag::kControllerData)
                                     : board_.add_interface(module, "Sensor Output", flag::kSensorData);
  for (const PortInfo& port : ports) {
    const double value = inputs ? described.input(port.index).value() : described.output(port.index).value();
    const ElementId id =
        board_.add_port(interface, port.name, number_type(), inputs ? Access::kWrite : Access::kRead, value,
                        unit_code(port.unit));
    links_[id] = {source, part, port.index, port.name};
  }
}

void Mapping::add_parameters(ElementId module, std::size_t part) {
  const Part& described = plant_.parts()[part];
  const auto parameters = described.parameters();
  if (parameters.empty()) return;
  const ElementId interface = board_.add_interface(module, "Parameters", 0);
  for (const ParameterInfo& parameter : parameters) {
    const Type type = type_of(described.name(), parameter);
    const ElementId id =
        board_.add_port(interface, parameter.name, type, parameter.read_only ? Access::kRead : Access::kWrite,
                        to_board(type, parameter.value), unit_code(parameter.unit));
    links_[id] = {Source::kParameter, part, 0, parameter.name};
  }
}

void Mapping::add_blackboards(ElementId module, std::size_t part) {
  const auto& boards = plant_.parts()[part].blackboards();
  if (boards.empty()) return;
  const ElementId folder = board_.add_plain(module, "Blackboards");
  for (std::size_t index = 0; index < boards.size(); ++index) {
    const ElementId board = board_.add_plain(folder, boards[index].name);
    const ElementId read = board_.add_port(board, "read", a_text(), Access::kRead, std::string());
    links_[read] = {Source::kBoardText, part, index, boards[index].name};
    if (!boards[index].writable) continue;
    const ElementId write = board_.add_port(board, "write", a_text(), Access::kWrite, std::string());
    links_[write] = {Source::kBoardNew, part, index, boards[index].name};
  }
}

void Mapping::refresh(std::chrono::steady_clock::time_point now) {
  plant_.refresh();
  const std::int64_t time_ns = board_.now_ns = wall_time_ns();
  std::vector<Inputs> inputs;
  std::vector<Outputs> outputs;
  for (const Part& part : plant_.parts()) {
    inputs.push_back(part.all_inputs());
    outputs.push_back(part.all_outputs());
  }
  for (const auto& [id, link] : links_) {
    if (link.source == Source::kInput) board_.set(id, inputs[link.part][link.index], time_ns);
    if (link.source == Source::kOutput) board_.set(id, outputs[link.part][link.index], time_ns);
  }
  if (!plant_.parts().empty()) {
    board_.set(time_, static_cast<double>(plant_.parts().front().sample_time_ns()) * 1e-9, time_ns);
  }
  controllers_.refresh(now, time_ns);
  if (settings_read_ && now - *settings_read_ < kSettingsEvery) return;
  settings_read_ = now;
  refresh_settings();
}

void Mapping::refresh_settings() {
  for (std::size_t part = 0; part < plant_.parts().size(); ++part) refresh_parameters(part);
  for (const auto& [id, link] : links_) {
    if (link.source == Source::kBoardText) refresh_blackboard(id, link);
  }
}

void Mapping::refresh_parameters(std::size_t part) {
  std::map<std::string, ParameterValue> values;
  for (auto& parameter : plant_.parts()[part].parameters()) values[parameter.name] = parameter.value;
  const std::int64_t time_ns = wall_time_ns();
  for (const auto& [id, link] : links_) {
    if (link.source != Source::kParameter || link.part != part || !values.contains(link.name)) continue;
    board_.set(id, to_board(board_.elements()[id].type, values[link.name]), time_ns);
  }
}

void Mapping::refresh_blackboard(ElementId id, const Link& link) {
  const Part& part = plant_.parts()[link.part];
  const BlackboardInfo& board = part.blackboards()[link.index];
  board_.set(id, shown(board, part.read_blackboard(link.name)), wall_time_ns());
}

std::string Mapping::write(ElementId id, const Value& value, const std::string& peer) {
  if (cycle_ != nullptr && id == step_) return note(id, ask_for_steps(value));
  if (controllers_.owns(id)) return note(id, controllers_.write(id, as_double(value)));
  const auto link = links_.find(id);
  if (link == links_.end()) return "this port is the bridge's own";
  const bool stops = link->second.name == protocol::kEmergencyStop && value == Value(true);
  if (cycle_ != nullptr && !stops) return note(id, latch(id, link->second, value, peer));
  const std::string refusal = write_to_plant(board_.elements()[id], link->second, value);
  // An accepted value is in force from the next tick on; until then it is shown as it was written.
  if (refusal.empty()) show_written(id, value);
  return note(id, refusal);
}

void Mapping::show_written(ElementId id, const Value& value) {
  if (board_.elements()[id].value.index() == value.index()) board_.set(id, value, wall_time_ns());
  settings_read_.reset();
}

// Only the range is known at once. What is refused at the end of the cycle is noted then.
std::string Mapping::latch(ElementId id, const Link& link, const Value& value, const std::string& peer) {
  if (link.source == Source::kInput) {
    std::string refusal = plant_.check_input(link.part, link.index, as_double(value));
    if (!refusal.empty()) return refusal;
  }
  const auto act = [this, id, link, value] {
    const std::string refusal = write_to_plant(board_.elements()[id], link, value);
    if (note(id, refusal).empty()) {
      show_written(id, value);
    } else {
      board_.send_again(id);
    }
  };
  return cycle_->latch({peer, plant_.parts()[link.part].name() + "/" + link.name, act});
}

// The counter says how many cycles were asked for in all.
std::string Mapping::ask_for_steps(const Value& counter) {
  const auto now = static_cast<std::int64_t>(as_double(board_.elements()[step_].value));
  const double wanted = as_double(counter);
  if (!(std::abs(wanted) < 1e15)) return "it counts cycles: write a whole number";
  const std::string refusal = cycle_->ask_for_steps(static_cast<std::int64_t>(wanted) - now);
  if (refusal.empty()) board_.set(step_, static_cast<std::int64_t>(wanted), wall_time_ns());
  return refusal;
}

// Makes a refusal visible to tools that get no answer. Returns it as it is.
std::string Mapping::note(ElementId id, const std::string& refusal) {
  if (refusal.empty()) return {};
  const std::string text = board_.path(id) + ": " + refusal;
  spdlog::warn("refused: {}", text);
  board_.set(last_refusal_, text, wall_time_ns());
  board_.set(refusals_, ++refused_, wall_time_ns());
  return refusal;
}

std::string Mapping::write_to_plant(const Element& element, const Link& link, const Value& value) {
  switch (link.source) {
    case Source::kInput:
      return plant_.set_input(link.part, link.index, as_double(value));
    case Source::kParameter:
      return plant_.set_parameter(link.part, link.name, to_server(element, value));
    case Source::kBoardNew: {
      const std::string& content = std::get<std::string>(value);
      return plant_.write_blackboard(link.part, link.name, std::as_bytes(std::span(content)));
    }
    case Source::kOutput:
    case Source::kBoardText:
      break;
  }
  return "it is an output";
}

}  // namespace visum::finroc
