#include "clients/bridges/finroc/mapping.h"

#include <spdlog/spdlog.h>

#include <cmath>

#include "clients/bridges/finroc/settings.h"
#include "protocol/part_description.h"

namespace visum::finroc {
namespace {

constexpr std::chrono::milliseconds kSettingsEvery{500};

std::int64_t wall_time_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
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
  last_refusal_ = board_.add_port(outputs, "Last Refusal", text_type(), Access::kRead, std::string());
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
    const Type type = setting_type(described.name(), parameter.name, parameter.value, parameter.choices);
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
    const ElementId read = board_.add_port(board, "read", text_type(), Access::kRead, std::string());
    links_[read] = {Source::kBoardText, part, index, boards[index].name};
    if (!boards[index].writable) continue;
    const ElementId write = board_.add_port(board, "write", text_type(), Access::kWrite, std::string());
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
  const auto data = part.read_blackboard(link.name);
  board_.set(id, shown(board.content_type, board.element_size, data, data.size()), wall_time_ns());
}

std::string Mapping::write(ElementId id, const Value& value, const std::string& peer) {
  if (cycle_ != nullptr && id == step_) return note(id, ask_for_steps(value));
  if (controllers_.owns(id)) return note(id, controllers_.write(id, value));
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
