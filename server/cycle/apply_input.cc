#include "server/cycle/apply_input.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "hwparts/powercube/module_bus.h"
#include "protocol/config/unknown_name.h"

namespace visum::cycle {
namespace {

// One function for each kind of input.
class Applier {
 public:
  explicit Applier(Simulation& simulation) : simulation_(simulation) {}

  Outcome operator()(const recording::WriteInputs& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    if (auto outcome = fits_ports(simulation_.parts()[*part], input); !outcome.done()) return outcome;
    simulation_.write_inputs(*part, input.first_port, input.values);
    return {};
  }
  Outcome operator()(const recording::LoseController& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    simulation_.lose_controller(*part);
    return {};
  }
  Outcome operator()(const recording::SetParameter& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    return simulation_.set_parameter(*part, std::string(input.name), input.value);
  }
  Outcome operator()(const recording::WriteBlackboard& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    const auto& boards = simulation_.parts()[*part].part->description().blackboards;
    const auto board = std::ranges::find(boards, input.name, &protocol::Blackboard::name);
    if (board == boards.end() || !board->writable)
      return {Refusal::kUnknownName, "no blackboard '" + std::string(input.name) + "' can be written"};
    const auto index = static_cast<std::size_t>(board - boards.begin());
    return simulation_.write_blackboard(*part, index, input.offset, input.data);
  }
  Outcome operator()(const recording::BusTelegram& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    if (!simulation_.parts()[*part].part->modules())
      return {Refusal::kBadValue, "'" + std::string(input.part) + "' has no modules"};
    powercube::Telegram telegram{static_cast<powercube::Telegram::Kind>(input.kind), input.module, {}};
    for (const std::byte byte : input.data) telegram.message.put(std::to_integer<std::uint8_t>(byte));
    simulation_.handle_telegram(*part, telegram, static_cast<powercube::BusFraming>(input.wire));
    return {};
  }
  Outcome operator()(const recording::PushBody& input) const {
    if (!is_body(input.body)) return unknown_body(input.body);
    if (!finite(input.force_n) || !finite(input.torque_nm))
      return {Refusal::kBadValue, "the force and torque of a push must be finite"};
    const dynamics::Wrench wrench{world::BodyId{input.body}, Eigen::Vector3d(input.force_n.data()),
                                  Eigen::Vector3d(input.torque_nm.data())};
    return simulation_.push({wrench, input.until_tick});
  }
  Outcome operator()(const recording::SetBody& input) const {
    const auto& [x, y, z, qw, qx, qy, qz] = input.pose;
    const world::Pose X_WB{{x, y, z}, {qw, qx, qy, qz}};
    if (!is_body(input.body)) return unknown_body(input.body);
    if (input.moves && !(std::abs(X_WB.q.norm() - 1.0) <= 1e-3))
      return {Refusal::kBadValue, "the quaternion is not of unit length"};
    return simulation_.set_body(world::BodyId{input.body}, input.moves ? std::optional(X_WB) : std::nullopt,
                                Eigen::Vector3d(input.velocity.data()),
                                Eigen::Vector3d(input.turn_rate.data()));
  }
  Outcome operator()(const recording::SetJoints& input) const {
    std::vector<world::JointPlacement> to;
    for (std::size_t i = 0; i < input.joints.size(); ++i) {
      if (input.joints[i] < 0 ||
          static_cast<std::size_t>(input.joints[i]) >= simulation_.model().joints.size())
        return {Refusal::kUnknownName, "there is no joint number " + std::to_string(input.joints[i])};
      to.push_back({world::JointId{input.joints[i]}, input.positions[i], input.velocities[i]});
    }
    return simulation_.set_joints(to);
  }
  Outcome operator()(const recording::PullBody& input) const {
    if (!is_body(input.body)) return unknown_body(input.body);
    if (!finite(input.point) || !finite(input.target) || !(input.max_force_n > 0.0) ||
        !std::isfinite(input.max_force_n))
      return {Refusal::kBadValue, "point, target and greatest force of a pull must be finite"};
    return simulation_.pull({world::BodyId{input.body}, Eigen::Vector3d(input.point.data()),
                             Eigen::Vector3d(input.target.data()), input.max_force_n, input.until_tick});
  }
  Outcome operator()(const recording::ReleaseBody& input) const {
    if (is_body(input.body) && simulation_.release(world::BodyId{input.body})) return {};
    return {Refusal::kWrongState, "nobody pulls the body number " + std::to_string(input.body)};
  }
  Outcome operator()(const recording::Reset& input) const { return simulation_.reset_now(input.scope); }
  Outcome operator()(const recording::TakeSnapshot& input) const {
    const auto number = simulation_.take_snapshot();
    if (number == input.number) return {};
    return {Refusal::kWrongState, "the snapshot is number " + std::to_string(number)};
  }
  Outcome operator()(const recording::RestoreSnapshot& input) const {
    return simulation_.restore_snapshot(input.number);
  }
  Outcome operator()(const recording::RestoreState& input) const {
    return simulation_.restore_state(*input.state);
  }
  Outcome operator()(const recording::AddBody& input) const {
    return simulation_.add_body(std::string(input.yaml));
  }
  Outcome operator()(const recording::RemoveBody& input) const {
    return simulation_.remove_body(std::string(input.name));
  }
  Outcome operator()(const recording::SpawnModel& input) const { return simulation_.spawn(input.model); }
  Outcome operator()(const recording::RemoveModel& input) const {
    return simulation_.remove_model(std::string(input.name));
  }
  Outcome operator()(const recording::LoadScene& input) const { return simulation_.load_scene(input.scene); }
  Outcome operator()(const recording::InjectFault& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    const auto* kind = hwparts::find_fault_kind(input.kind);
    if (!kind) return unknown_fault(input.kind);
    std::string why;
    const auto fault = hwparts::make_fault(*kind, input.numbers, why);
    if (!fault) return {Refusal::kBadValue, why};
    if (input.until_tick < 0)
      return {Refusal::kBadValue, "a fault cannot end at tick " + std::to_string(input.until_tick)};
    const auto& broken = *simulation_.parts()[*part].part;
    if (auto outcome = outcome_of(broken.refuse_fault(*fault)); !outcome.done()) return outcome;
    auto room = NetworkModel::has_room_for(*fault, broken.description(), simulation_.model().tick_ns);
    if (!room.done()) return room;
    return simulation_.inject({static_cast<std::uint32_t>(*part), *fault, input.until_tick});
  }
  Outcome operator()(const recording::ClearFault& input) const {
    const auto part = find(input.part);
    if (!part) return unknown(input.part);
    const auto* kind = hwparts::find_fault_kind(input.kind);
    if (!kind && !input.kind.empty()) return unknown_fault(input.kind);
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
  Outcome unknown(std::string_view part) const {
    std::vector<std::string> known;
    for (const auto& bound : simulation_.parts()) known.push_back(bound.part->description().name);
    return {Refusal::kUnknownName, config::unknown_name("part", part, known)};
  }
  static bool finite(std::span<const double> numbers) {
    return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
  }
  bool is_body(std::int32_t number) const {
    return number >= 0 && static_cast<std::size_t>(number) < simulation_.model().bodies.size();
  }
  static Outcome unknown_body(std::int32_t number) {
    return {Refusal::kUnknownName, "there is no body number " + std::to_string(number)};
  }
  static Outcome unknown_fault(std::string_view kind) {
    std::vector<std::string> known;
    for (const auto& info : hwparts::fault_kinds()) known.emplace_back(info.name);
    return {Refusal::kUnknownName, config::unknown_name("fault", kind, known)};
  }
  // Checks each value for itself. Part::refuse() is not asked: it judges all inputs together, and the gateway
  // asked it with writes that may still be under way here, or lost.
  static Outcome fits_ports(const BoundPart& bound, const recording::WriteInputs& input) {
    const auto& ports = bound.part->description().controller_inputs;
    if (input.first_port > ports.size() || input.values.size() > ports.size() - input.first_port)
      return {Refusal::kBadValue,
              "'" + std::string(input.part) + "' has " + std::to_string(ports.size()) + " controller inputs"};
    for (std::size_t i = 0; i < input.values.size(); ++i) {
      const auto& port = ports[input.first_port + i];
      if (!(input.values[i] >= port.minimum && input.values[i] <= port.maximum))
        return {Refusal::kBadValue, "'" + port.name + "' takes no " + std::to_string(input.values[i])};
    }
    return {};
  }

  Simulation& simulation_;
};

}  // namespace

Outcome apply(Simulation& simulation, const recording::Input& input) {
  return std::visit(Applier(simulation), input);
}

}  // namespace visum::cycle
