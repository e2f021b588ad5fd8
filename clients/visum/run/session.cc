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

protocol::Hello hello() {
  return {protocol::kProtocolVersion, protocol::kProtocolVersion, Session::kName, protocol::Role::kAdmin, {}};
}

}  // namespace

Session::Session(std::uint16_t port, Vigil& vigil) : vigil_(vigil), connection_("127.0.0.1", port, hello()) {}

// While controllers start, and while their ends are waited for, the world waits for us; that has limits of
// its own.
void Session::join() {
  connection_.request(protocol::Join{nanoseconds(hours(24)).count()});
}

Catalogue Session::catalogue() {
  Catalogue catalogue;
  catalogue.world = connection_.request_as<protocol::WorldDescription>(protocol::DescribeWorld{});
  for (const auto& part : connection_.request_as<protocol::PartList>(protocol::ListParts{}).parts) {
    auto reply = connection_.request_as<protocol::PartDescriptionReply>(protocol::DescribePart{part.name});
    catalogue.parts[part.name] = std::move(reply.description);
  }
  return catalogue;
}

Observation Session::look(const std::set<std::string>& parts) {
  const auto world_id = connection_.send(protocol::ReadWorld{});
  std::vector<std::uint64_t> part_ids;
  for (const auto& part : parts) part_ids.push_back(connection_.send(protocol::Read{part}));
  return take(world_id, part_ids);
}

Observation Session::step(std::int64_t ticks, const std::set<std::string>& parts) {
  const auto advance_id = connection_.send(protocol::Advance{ticks});
  const auto world_id = connection_.send(protocol::ReadWorld{});
  std::vector<std::uint64_t> part_ids;
  for (const auto& part : parts) part_ids.push_back(connection_.send(protocol::Read{part}));
  try {
    // Events, which are no answer, make the socket readable too.
    while (!connection_.wait_for(advance_id, std::chrono::milliseconds(0)))
      vigil_.wait(connection_.native_handle());
  } catch (const protocol::RequestError& error) {
    if (error.code() == protocol::ErrorCode::kTimeout) throw cli::ExitError(cli::kLost, error.what());
    throw cli::ExitError(cli::kFailed, std::string("the world stopped: ") + error.what());
  }
  return take(world_id, part_ids);
}

Observation Session::take(std::uint64_t world_id, const std::vector<std::uint64_t>& part_ids) {
  Observation now;
  now.world = as<protocol::WorldSample>(connection_.wait(world_id));
  for (const auto id : part_ids) {
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
    if (event != nullptr && event->kind == "lockstep_timeout") throw cli::ExitError(cli::kLost, event->text);
  }
}

}  // namespace visum::run
