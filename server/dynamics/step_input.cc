#include "server/dynamics/step_input.h"

#include <cmath>

namespace visum::dynamics {
namespace {

constexpr double kLongestTickS = 1.0;

const char* drive_fault(const hwparts::JointDrive& drive) {
  if (!std::isfinite(drive.target_velocity)) return "a target velocity that is not finite";
  if (!std::isfinite(drive.feedforward)) return "a feedforward that is not finite";
  if (!std::isfinite(drive.compliance) || drive.compliance < 0.0)
    return "a compliance that is negative or not finite";
  if (!std::isfinite(drive.max_effort) || drive.max_effort < 0.0)
    return "a torque limit that is negative or not finite";
  return nullptr;
}

// A quick test by few instructions, without branches. True: all drives are without a fault. False means
// nothing yet, since a sum of squares may overflow.
bool are_plain(std::span<const hwparts::JointDrive> drives) {
  using Pair = double __attribute__((vector_size(16)));
  using Mask = long long __attribute__((vector_size(16)));
  Pair squares{0.0, 0.0};
  Mask negative{0, 0};
  for (const hwparts::JointDrive& drive : drives) {
    const Pair goals{drive.target_velocity, drive.feedforward}, bounds{drive.compliance, drive.max_effort};
    squares += goals * goals + bounds * bounds;
    negative |= bounds < Pair{0.0, 0.0};
  }
  return std::isfinite(squares[0] + squares[1]) && (negative[0] | negative[1]) == 0;
}

// First the quick test, then one by one to name the joint.
std::string find_drive_fault(const world::WorldModel& model, std::span<const hwparts::JointDrive> drives) {
  if (drives.size() != model.joints.size())
    return std::to_string(drives.size()) + " drives for " + std::to_string(model.joints.size()) + " joints";
  if (are_plain(drives)) return "";
  for (std::size_t i = 0; i < drives.size(); ++i) {
    if (const char* fault = drive_fault(drives[i]); fault != nullptr)
      return "joint '" + model.joints[i].name + "' was given " + fault;
  }
  return "";
}

std::string find_wrench_fault(const world::WorldModel& model, std::span<const Wrench> wrenches) {
  for (const Wrench& wrench : wrenches) {
    if (!wrench.body.valid() || wrench.body.index() >= model.bodies.size())
      return "a force acts on a body that does not exist";
    if (!wrench.force_n.allFinite() || !wrench.torque_nm.allFinite())
      return "body '" + model.bodies[wrench.body.index()].name + "' was given a force that is not finite";
  }
  return "";
}

// Finite numbers in their ranges; restitution is 0..1.
bool is_usable(const collision::Contact& contact) {
  return contact.p_W.allFinite() && contact.normal_W.allFinite() && std::isfinite(contact.depth) &&
         contact.friction >= 0.0 && std::isfinite(contact.friction) && contact.restitution >= 0.0 &&
         contact.restitution <= 1.0 && contact.rolling_friction >= 0.0 &&
         std::isfinite(contact.rolling_friction) && contact.torsional_friction >= 0.0 &&
         std::isfinite(contact.torsional_friction);
}

std::string find_contact_fault(const world::WorldModel& model, std::span<const collision::Contact> contacts) {
  for (const collision::Contact& contact : contacts) {
    for (const world::BodyId body : {contact.body_a, contact.body_b}) {
      if (!body.valid() || body.index() >= model.bodies.size())
        return "a contact touches a body that does not exist";
    }
    if (!is_usable(contact))
      return "the contact of body '" + model.bodies[contact.body_a.index()].name + "' with body '" +
             model.bodies[contact.body_b.index()].name + "' is not finite";
  }
  return "";
}

std::string find_state_fault(const world::WorldModel& model, const world::WorldState& state) {
  if (state.bodies.size() != model.bodies.size() || state.joints.size() != model.joints.size() ||
      state.engines.size() != model.engines.size())
    return "the state belongs to another world";
  std::string offender;
  is_sane(model, state, &offender);
  return offender;
}

}  // namespace

std::string find_input_fault(const world::WorldModel& model, const StepInput& input,
                             const world::WorldState& state) {
  if (!(input.tick_s > 0.0 && input.tick_s <= kLongestTickS)) return "the tick is not between 0 and 1 s";
  if (std::string fault = find_state_fault(model, state); !fault.empty()) return fault;
  if (std::string fault = find_drive_fault(model, input.drives); !fault.empty()) return fault;
  if (std::string fault = find_wrench_fault(model, input.wrenches); !fault.empty()) return fault;
  return find_contact_fault(model, input.contacts);
}

}  // namespace visum::dynamics
