#include "server/cycle/apply_input.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <optional>

#include "hwparts/powercube/module_bus.h"

namespace visum::cycle {
namespace {

class Applier {
 public:
  explicit Applier(Simulation& simulation) : simulation_(simulation) {}

  std::string operator()(const recording::WriteInputs& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    if (auto reason = why_not(simulation_.parts()[*part], input); !reason.empty()) return reason;
    simulation_.write_inputs(*part, input.first_port, input.values);
    return {};
  }
  std::string operator()(const recording::LoseController& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    simulation_.lose_controller(*part);
    return {};
  }
  std::string operator()(const recording::SetParameter& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    return simulation_.set_parameter(*part, std::string(input.name), input.value).value_or("");
  }
  std::string operator()(const recording::WriteBlackboard& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    const auto& boards = simulation_.parts()[*part].part->description().blackboards;
    const auto board = std::ranges::find(boards, input.name, &protocol::Blackboard::name);
    if (board == boards.end() || !board->writable)
      return "no blackboard '" + std::string(input.name) + "' can be written";
    const auto index = static_cast<std::size_t>(board - boards.begin());
    return simulation_.write_blackboard(*part, index, input.offset, input.data).value_or("");
  }
  std::string operator()(const recording::BusTelegram& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    if (!simulation_.parts()[*part].part->modules())
      return "'" + std::string(input.part) + "' has no modules";
    powercube::Telegram telegram{static_cast<powercube::Telegram::Kind>(input.kind), input.module, {}};
    for (const std::byte byte : input.data) telegram.message.put(std::to_integer<std::uint8_t>(byte));
    simulation_.handle_telegram(*part, telegram, static_cast<powercube::BusFraming>(input.wire));
    return {};
  }
  std::string operator()(const recording::PushBody& input) const {
    const auto finite = [](const auto& numbers) {
      return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
    };
    if (input.body < 0 || static_cast<std::size_t>(input.body) >= simulation_.model().bodies.size())
      return "there is no body number " + std::to_string(input.body);
    if (!finite(input.force_n) || !finite(input.torque_nm)) return "a push that is no number";
    const dynamics::Wrench wrench{world::BodyId{input.body}, Eigen::Vector3d(input.force_n.data()),
                                  Eigen::Vector3d(input.torque_nm.data())};
    return simulation_.push({wrench, input.until_tick}) ? "" : "too many pushes act at once";
  }
  std::string operator()(const recording::Reset&) const {
    simulation_.reset();
    return {};
  }
  std::string operator()(const recording::TakeSnapshot& input) const {
    const auto number = simulation_.take_snapshot();
    return number == input.number ? "" : "the snapshot is number " + std::to_string(number);
  }
  std::string operator()(const recording::RestoreSnapshot& input) const {
    std::string why;
    simulation_.restore_snapshot(input.number, &why);
    return why;
  }
  std::string operator()(const recording::AddBody& input) const {
    try {
      simulation_.add_body(std::string(input.yaml));
    } catch (const std::bad_alloc&) {
      throw;  // no body's fault
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  }
  std::string operator()(const recording::RemoveBody& input) const {
    return simulation_.remove_body(std::string(input.name));
  }
  std::string operator()(const recording::InjectFault& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    const auto* kind = hwparts::find_fault_kind(input.kind);
    if (!kind) return "there is no fault '" + std::string(input.kind) + "'";
    std::string why;
    const auto fault = hwparts::make_fault(*kind, input.numbers, why);
    if (!fault) return why;
    if (input.until_tick < 0) return "a fault until tick " + std::to_string(input.until_tick);
    const auto& broken = *simulation_.parts()[*part].part;
    if (auto reason = broken.refuse_fault(*fault)) return *reason;
    if (auto reason = NetworkModel::refuse(*fault, broken.description(), simulation_.model().tick_ns))
      return *reason;
    return simulation_.inject({static_cast<std::uint32_t>(*part), *fault, input.until_tick})
               ? ""
               : "too many faults act at once";
  }
  std::string operator()(const recording::ClearFault& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    const auto* kind = hwparts::find_fault_kind(input.kind);
    if (!kind && !input.kind.empty()) return "there is no fault '" + std::string(input.kind) + "'";
    std::optional<hwparts::FaultKind> only;
    std::optional<std::size_t> drive;
    if (kind) only = kind->kind;
    if (input.drive != 0) drive = input.drive - 1;
    simulation_.clear_faults(*part, only, drive);
    return {};
  }

 private:
  std::optional<std::size_t> find(std::string_view name) const {
    const auto parts = simulation_.parts();
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].part->description().name == name) return i;
    return {};
  }
  static std::string unknown(std::string_view part) { return "there is no part '" + std::string(part) + "'"; }
  // What a part demands of its inputs together was judged by what its controller had written, some of which
  // may be under way still, or lost.
  static std::string why_not(const BoundPart& bound, const recording::WriteInputs& input) {
    const auto& ports = bound.part->description().controller_inputs;
    if (input.first_port > ports.size() || input.values.size() > ports.size() - input.first_port)
      return "'" + std::string(input.part) + "' has " + std::to_string(ports.size()) + " controller inputs";
    for (std::size_t i = 0; i < input.values.size(); ++i) {
      const auto& port = ports[input.first_port + i];
      if (!(input.values[i] >= port.minimum && input.values[i] <= port.maximum))
        return "'" + port.name + "' takes no " + std::to_string(input.values[i]);
    }
    return {};
  }

  Simulation& simulation_;
};

}  // namespace

std::string apply(Simulation& simulation, const recording::Input& input) {
  return std::visit(Applier(simulation), input);
}

}  // namespace visum::cycle
