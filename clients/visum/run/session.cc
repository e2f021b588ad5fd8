#include "clients/visum/run/session.h"

#include "clients/visum/common/exit_code.h"
#include "protocol/limits.h"

namespace visum::run {
namespace {

using std::chrono::hours;
using std::chrono::nanoseconds;

template <typename T>
T as(protocol::Reply reply) {
  if (auto* value = std::get_if<T>(&reply)) return std::move(*value);
  throw cli::ExitError(cli::kFailed, "visumd answered with a message of another kind");
}

std::vector<protocol::Request> to_look(const std::set<std::string>& parts) {
  std::vector<protocol::Request> requests{protocol::ReadWorld{}};
  for (const auto& part : parts) requests.push_back(protocol::Read{part});
  return requests;
}

protocol::Hello hello(const char* name) {
  return {protocol::kProtocolVersion, protocol::kProtocolVersion, name, protocol::Role::kAdmin, {}};
}

}  // namespace

Session::Session(std::uint16_t port, WaitLoop& wait_loop)
    : wait_loop_(wait_loop), connection_("127.0.0.1", port, hello(kName)) {
  if (clock() == "lockstep") waiter_.emplace("127.0.0.1", port, hello(kWaiterName));
}

// The world waits for us while controllers start and end. These waits have limits of their own, so this one
// is a day.
void Session::join() {
  const protocol::Join patiently{nanoseconds(hours(24)).count()};
  era_ = connection_.request_as<protocol::Advanced>(patiently).era;
  if (!waiter_) return;
  waiter_->request(patiently);
  waiter_->send(protocol::Advance{kMostTicks + 1});
}

Catalogue Session::catalogue() {
  Catalogue catalogue;
  catalogue.world = connection_.request_as<protocol::WorldDescription>(protocol::DescribeWorld{});
  for (const auto& part : connection_.request_as<protocol::PartList>(protocol::ListParts{}).parts) {
    auto reply = connection_.request_as<protocol::PartDescriptionReply>(protocol::DescribePart{part.name});
    catalogue.parts[part.name] = std::move(reply.description);
    catalogue.faults[part.name] =
        connection_.request_as<protocol::FaultList>(protocol::ListFaults{part.name}).kinds;
  }
  return catalogue;
}

Observation Session::look(const std::set<std::string>& parts) {
  const auto ids = connection_.send_together(to_look(parts));
  return take(ids);
}

Session::Step Session::step(std::int64_t ticks, const std::set<std::string>& parts) {
  std::vector<protocol::Request> requests{protocol::Advance{ticks}, protocol::Status{}};
  for (auto& request : to_look(parts)) requests.push_back(std::move(request));
  const auto ids = connection_.send_together(requests);
  await_advance(ids[0]);
  Step step;
  step.status = as<protocol::ServerStatus>(connection_.wait(ids[1]));
  step.now = take(std::span(ids).subspan(2));
  if (step.now.world.era != era_)
    throw cli::ExitError(cli::kFailed, "the world was reset or restored from outside");
  hear_events();
  return step;
}

// Waits in a loop, because events make the socket readable too.
void Session::await_advance(std::uint64_t id) try {
  while (!connection_.wait_for(id, std::chrono::milliseconds(0)))
    wait_loop_.wait(connection_.native_handle());
} catch (const protocol::RequestError& error) {
  if (error.code() == protocol::ErrorCode::kTimeout) throw cli::ExitError(cli::kLost, error.what());
  throw cli::ExitError(cli::kFailed, std::string("the world stopped: ") + error.what());
}

// The answers to to_look().
Observation Session::take(std::span<const std::uint64_t> ids) {
  Observation now;
  now.world = as<protocol::WorldSample>(connection_.wait(ids.front()));
  for (const auto id : ids.subspan(1)) {
    auto sample = as<protocol::PartSample>(connection_.wait(id));
    now.parts[sample.part] = std::move(sample);
  }
  return now;
}

protocol::ServerStatus Session::status() {
  auto status = connection_.request_as<protocol::ServerStatus>(protocol::Status{});
  hear_events();
  return status;
}

// Events come before the status that already shows their effect.
void Session::hear_events() {
  while (const auto message = connection_.next(std::chrono::milliseconds(0))) {
    const auto* event = std::get_if<protocol::Event>(&*message);
    if (event != nullptr && event->kind == "lockstep_timeout") timeouts_.push_back(event->text);
  }
}

}  // namespace visum::run
