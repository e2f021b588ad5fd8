#include "clients/visum/exec/world_link.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/exec/membership.h"

namespace visum::exec {
namespace {

constexpr std::chrono::milliseconds kLook{20};
constexpr std::int64_t kPiece_ns = 1'000'000;

}  // namespace

WorldLink::WorldLink(protocol::Connection connection, const protocol::Join& join, std::function<bool()> idle)
    : connection_(std::move(connection)), on_timeout_(join.on_timeout), idle_(std::move(idle)) {
  const auto joined = exec::join(connection_, join);
  era_ = joined.era;
  world_ns_ = joined.sim_time_ns;
}

bool WorldLink::advance(std::int64_t ticks, std::vector<protocol::Stream>& streams) try {
  // An event that has not been read yet shows in the answer: a member that was thrown out gets an error.
  if (!free_since_) take_reason(why_thrown_out_by_now(connection_));
  if (free_since_) return pass_freely(ticks), true;
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
  look();
  if (!free_since_) throw cli::ExitError(cli::kLost, error.what());
  return pass_freely(ticks), true;
}

void WorldLink::look() {
  if (!free_since_) take_reason(why_thrown_out(connection_));
}

void WorldLink::take_reason(const std::optional<std::string>& why) {
  if (!why) return;
  if (on_timeout_ != protocol::OnTimeout::kFree) throw cli::ExitError(cli::kLost, *why);
  say_dropped(*why);
  free_since_ = Clock::now();
  free_from_ns_ = world_ns_;
}

// Passes real time in pieces: a bus may send something at any moment.
void WorldLink::pass_freely(std::int64_t ticks) {
  using std::chrono::nanoseconds;
  spoke_ = true;
  const auto until = world_ns_ + std::min(ticks * tick_ns(), kPiece_ns);
  std::this_thread::sleep_until(*free_since_ + nanoseconds(until - free_from_ns_));
  world_ns_ = until;
}

void WorldLink::follow(const protocol::Advanced& advanced) {
  if (advanced.era != era_) offset_ns_ = now_ns() - advanced.sim_time_ns;
  era_ = advanced.era;
  world_ns_ = advanced.sim_time_ns;
  spoke_ = advanced.bus_said > bus_said_;
  bus_said_ = advanced.bus_said;
}

void WorldLink::note(const std::string& text) {
  look();
  if (!free_since_) connection_.request(protocol::Note{text});
}

void WorldLink::leave() {
  if (!free_since_) exec::leave(connection_);
}

protocol::ServerStatus WorldLink::status() {
  return connection_.request_as<protocol::ServerStatus>(protocol::Status{});
}

}  // namespace visum::exec
