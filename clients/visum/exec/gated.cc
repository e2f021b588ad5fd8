// Grade L1: the program runs in real time. Its requests over a bus or a session let the world run.
#include <sys/wait.h>

#include <chrono>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/exec/launch.h"
#include "clients/visum/exec/lockstep.h"
#include "clients/visum/exec/membership.h"

namespace visum::exec {
namespace {

constexpr std::chrono::seconds kFarewell{5};  // how long to wait for the world once the program has ended

// Lets the world handle the last bytes that the program wrote.
void settle(protocol::Connection& world) {
  world.wait_for(world.send(protocol::Advance{0, true, 0, {}}), kFarewell);
}

}  // namespace

LockstepEnd run_gated(protocol::Connection world, const LockstepPlan& plan) {
  join(world, plan.join);
  bool member = true;
  const auto look = [&] {
    const auto why = why_thrown_out(world);  // also once it is out: an unread message would wake us for ever
    if (!why || !member) return;
    if (plan.join.on_timeout != protocol::OnTimeout::kFree) throw cli::ExitError(cli::kLost, *why);
    say_dropped(*why);
    member = false;
  };
  const pid_t program = launch(plan.command, plan.placements);
  const int status = await_end(program, plan.give_up, world.native_handle(), look);
  look();
  if (member) settle(world);
  const auto last = world.request_as<protocol::ServerStatus>(protocol::Status{});
  if (member && WIFEXITED(status)) leave(world);
  return {status, last, {}, was_started()};
}

}  // namespace visum::exec
