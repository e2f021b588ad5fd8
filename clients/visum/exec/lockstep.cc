#include "clients/visum/exec/lockstep.h"

#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>

#include "clients/visum/exec/launch.h"
#include "clients/visum/exec/scheduler.h"
#include "protocol/local_socket.h"

namespace visum::exec {
namespace {

// Tells the shim the devices and ports of the world's buses: "pty:/tmp/arm.tty", "slcan:...", "tcp:40123".
void add_buses(const std::vector<protocol::PartBus>& buses, TimeChannel& channel) {
  for (const auto& bus : buses) {
    const auto colon = bus.name.find(':');
    const auto kind = bus.name.substr(0, colon), where = bus.name.substr(colon + 1);
    struct stat status {};
    if (kind == "tcp")
      channel.add_port(static_cast<std::uint16_t>(std::atoi(where.c_str())));
    else if (::stat(where.c_str(), &status) == 0)
      channel.add_tty(status.st_rdev);
  }
}

}  // namespace

LockstepEnd run_in_lockstep(protocol::Connection connection, const LockstepPlan& plan) {
  const auto buses = connection.request_as<protocol::ServerStatus>(protocol::Status{}).buses;
  std::unique_ptr<Scheduler> scheduler;
  WorldLink world(std::move(connection), plan.join, [&scheduler] { return scheduler->is_patient(); });
  TimeChannel channel(world.tick_ns());
  channel.memory().now_ns = world.now_ns();
  add_buses(buses, channel);
  channel.set_session_port(plan.session_port);
  channel.export_to_environment();
  ::unsetenv(protocol::kLocalVariable);  // the shim follows what the program sends over TCP
  const pid_t program = launch(plan.command, plan.placements);
  scheduler = std::make_unique<Scheduler>(
      channel, world, program, std::max<std::int64_t>(1, plan.period_ns / world.tick_ns()), plan.give_up);
  try {
    const int status = scheduler->run();
    scheduler->kill_all();
    const auto last = world.status();
    if (WIFEXITED(status)) world.leave();
    const bool started = was_started();
    return {status, last, started ? scheduler->out_of_step() : std::string(), started};
  } catch (...) {
    scheduler->kill_all();
    throw;
  }
}

}  // namespace visum::exec
