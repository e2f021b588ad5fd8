#include "clients/visum/run/session.h"

#include <algorithm>
#include <sstream>

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
  const auto joined = connection_.request_as<protocol::Advanced>(patiently);
  era_ = joined.era;
  tick_ = joined.tick;
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

std::vector<std::string> Session::tripped(const Catalogue& catalogue) {
  std::vector<std::string> all;
  for (const auto& [name, part] : catalogue.parts) {
    if (std::ranges::find(part.parameters, protocol::kTripped, &protocol::Parameter::name) ==
        part.parameters.end())
      continue;
    const auto list = connection_.request_as<protocol::ParameterList>(protocol::GetParameters{name});
    for (const auto& parameter : list.parameters) {
      const auto* text = std::get_if<std::string>(&parameter.value);
      if (parameter.name != protocol::kTripped || !text || text->empty()) continue;
      std::istringstream lines(*text);
      for (std::string line; std::getline(lines, line);) all.push_back(name + ": " + line);
    }
  }
  return all;
}

Observation Session::look(const std::set<std::string>& parts) {
  const auto ids = connection_.send_together(to_look(parts));
  return take(ids);
}

// The server keeps at most 64 requests behind one that waits. What is sent ahead also delays the news of what
// happens outside the world, such as an interrupt.
std::size_t Session::most_steps(const std::set<std::string>& parts) {
  constexpr std::size_t kMostRequests = 60, kMostSteps = 16;
  return std::clamp<std::size_t>(kMostRequests / (2 + parts.size()), 1, kMostSteps);
}

void Session::send_steps(std::size_t count, std::int64_t ticks, const std::set<std::string>& parts,
                         std::uint32_t members) {
  const auto look = to_look(parts);
  std::vector<protocol::Request> requests;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_last = i + 1 == count;
    requests.push_back(protocol::Advance{ticks, false, 0, {}, members, !is_last});
    requests.insert(requests.end(), look.begin(), look.end());
  }
  const auto ids = connection_.send_together(requests);
  const auto each = static_cast<std::ptrdiff_t>(1 + look.size());
  for (auto id = ids.begin(); id != ids.end(); id += each) steps_.emplace_back(id, id + each);
}

std::optional<Observation> Session::take_step() {
  const auto ids = std::move(steps_.front());
  steps_.pop_front();
  const auto advanced = await_advance(ids[0]);
  auto now = take(std::span(ids).subspan(1));
  if (advanced.era != era_ || now.world.era != era_)
    throw cli::ExitError(cli::kFailed, "the world was reset or restored from outside");
  hear_events();
  if (std::exchange(tick_, advanced.tick) != advanced.tick) return now;
  while (!steps_.empty()) {  // they are answered at once, too
    for (const auto id : steps_.front()) connection_.wait(id);
    steps_.pop_front();
  }
  return std::nullopt;
}

// Waits in a loop, because events make the socket readable too.
protocol::Advanced Session::await_advance(std::uint64_t id) try {
  for (;;) {
    if (auto reply = connection_.wait_for(id, std::chrono::milliseconds(0)))
      return as<protocol::Advanced>(std::move(*reply));
    wait_loop_.wait(connection_.native_handle());
  }
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

void Session::end_world() {
  connection_.send(protocol::Shutdown{});
}

protocol::ServerStatus Session::status() {
  auto status = connection_.request_as<protocol::ServerStatus>(protocol::Status{});
  hear_events();
  return status;
}

// Events come before the status that already shows their effect.
void Session::hear_events() {
  while (const auto message = connection_.next_kept()) {
    const auto* event = std::get_if<protocol::Event>(&*message);
    if (event != nullptr && event->kind == "lockstep_timeout") timeouts_.push_back(event->text);
  }
}

}  // namespace visum::run
