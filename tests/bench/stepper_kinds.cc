#include "tests/bench/stepper_kinds.h"

#include "tests/bench/our_stepper.h"
#include "tests/bench/peers/peers.h"
#include "tests/dynamics/physics/engine_rows.h"

namespace visum::bench {
namespace {

std::vector<StepperKind> all_kinds() {
  std::vector<StepperKind> kinds;
  for (const auto& row : physics::engine_rows()) kinds.push_back({row.name, can_be_made, make_our_stepper});
#ifdef VISUM_PEER_ODE
  add_bare_ode(kinds);
#endif
#ifdef VISUM_PEER_MUJOCO
  add_mujoco(kinds);
#endif
#ifdef VISUM_PEER_BULLET
  add_bullet(kinds);
#endif
#ifdef VISUM_PEER_DART
  add_dart(kinds);
#endif
#ifdef VISUM_PEER_SIMBODY
  add_simbody(kinds);
#endif
#ifdef VISUM_PEER_KDL
  add_kdl(kinds);
#endif
  return kinds;
}

}  // namespace

const std::vector<StepperKind>& stepper_kinds() {
  static const std::vector<StepperKind> kinds = all_kinds();
  return kinds;
}

}  // namespace visum::bench
