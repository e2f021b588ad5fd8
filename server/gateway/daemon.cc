#include "server/gateway/daemon.h"

#include <stdexcept>

#include "server/gateway/daemon_loop.h"

namespace visum::gateway {

Daemon::Daemon(cycle::Simulation& simulation, const DaemonOptions& options) {
  if (!is_loopback(options.address) && options.token_file.empty())
    throw std::runtime_error("--listen " + options.address +
                             " is open to others than this machine: that needs --token-file");
  const bool realtime = simulation.scene().clock == scene::ClockKind::kRealtime;
  if (options.realtime_priority != 0 && !realtime)
    throw std::runtime_error("--realtime-priority is for worlds with the clock realtime");
  loop_ = realtime ? make_realtime_loop(simulation, options, stopping_)
                   : make_inline_loop(simulation, options, stopping_);
}

Daemon::~Daemon() = default;

std::uint16_t Daemon::port() const {
  return loop_->doors().server.port();
}

const bus::BusNames& Daemon::buses() const {
  return loop_->doors().buses.names();
}

std::uint16_t Daemon::http_port() const {
  return loop_->doors().server.http_port();
}

void Daemon::run() {
  loop_->doors().server.start();
  loop_->run();
}

}  // namespace visum::gateway
