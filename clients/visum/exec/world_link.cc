#include "clients/visum/exec/world_link.h"

#include <chrono>
#include <utility>

#include "clients/visum/common/exit_code.h"

namespace visum::exec {
namespace {

constexpr std::chrono::milliseconds kLook{20};

}  // namespace

WorldLink::WorldLink(protocol::Connection connection, const protocol::Join& join, std::function<bool()> idle)
    : connection_(std::move(connection)), idle_(std::move(idle)) {
  if (connection_.welcome().clock != "lockstep")
    throw cli::ExitError(cli::kUsage, "--lockstep: the server's clock is " + connection_.welcome().clock +
                                          "; start visumd with --clock lockstep");
  const auto joined = connection_.request_as<protocol::Advanced>(join);
  era_ = joined.era;
  world_ns_ = joined.sim_time_ns;
}

bool WorldLink::advance(std::int64_t ticks, std::vector<protocol::Stream>& streams) try {
  const auto id = connection_.send(protocol::Advance{ticks, true, bus_said_, streams});
  auto reply = connection_.wait_for(id, kLook);
  while (!reply) {
    if (!idle_()) return false;
    reply = connection_.wait_for(id, kLook);
  }
  const auto* advanced = std::get_if<protocol::Advanced>(&*reply);
  if (!advanced) throw cli::ExitError(cli::kLost, "the server answered with a message of another kind");
  follow(*advanced);
  for (std::size_t i = 0; i < streams.size() && i < advanced->streams.size(); ++i) {
    spoke_ |= advanced->streams[i].written > streams[i].heard;
    streams[i].heard = advanced->streams[i].written;
  }
  return true;
} catch (const protocol::RequestError& error) {
  throw cli::ExitError(cli::kLost, error.what());
}

void WorldLink::follow(const protocol::Advanced& advanced) {
  if (advanced.era != era_) offset_ns_ = now_ns() - advanced.sim_time_ns;
  era_ = advanced.era;
  world_ns_ = advanced.sim_time_ns;
  spoke_ = advanced.bus_said > bus_said_;
  bus_said_ = advanced.bus_said;
}

void WorldLink::note(const std::string& text) {
  connection_.request(protocol::Note{text});
}

protocol::ServerStatus WorldLink::status() {
  return connection_.request_as<protocol::ServerStatus>(protocol::Status{});
}

}  // namespace visum::exec
