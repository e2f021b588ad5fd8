#include "clients/bridges/common/plant.h"

#include "clients/cpp/client_access.h"
#include "protocol/client.h"
#include "protocol/part_description.h"
#include "protocol/stop_call.h"
#include "protocol/token_file.h"

namespace visum::bridge {
namespace {

constexpr std::chrono::milliseconds kStopPatience{300};

// Returns why the server refused. Only a lost connection is no refusal.
std::string refusal_of(const std::function<void()>& command) try {
  command();
  return {};
} catch (const Error& error) {
  if (error.code() == ErrorCode::kConnection) throw;
  return error.what();
}

}  // namespace

Plant::Plant(const std::string& address, const ClientOptions& options)
    : address_(address),
      options_(options),
      stop_token_(protocol::read_token_file(options.token_file, protocol::Role::kObserver)),
      client_(address, options) {
  for (const std::string& name : client_.part_names()) parts_.push_back(client_.part(name));
}

std::vector<std::string> Plant::names() const {
  std::vector<std::string> names;
  for (const Part& part : parts_) names.push_back(part.name());
  return names;
}

void Plant::refresh() {
  client_.read();
}

std::string Plant::under_lease(std::size_t part, const std::function<void(Part&)>& command) {
  Part& target = parts_.at(part);
  return refusal_of([&] {
    target.acquire();
    const std::string refusal = refusal_of([&] { command(target); });
    target.release();  // throws what was refused of a write
    if (!refusal.empty()) throw Error(ErrorCode::kBadValue, refusal);
  });
}

std::string Plant::check_input(std::size_t part, std::size_t port, double value) const {
  return refusal_of([&] { parts_.at(part).input(port).check(0, value); });
}

std::string Plant::set_input(std::size_t part, std::size_t port, double value) {
  return under_lease(part, [&](Part& target) {
    target.input(port).set(value);
    target.write();
  });
}

// Where the server takes no such datagrams, the order goes by a session of its own.
std::string Plant::stop(const std::string& part) {
  using State = protocol::StopNews::State;
  return refusal_of([&] {
    const auto [host, port] = protocol::parse_address(address_);
    const auto news = protocol::call_stop(host, port, part, stop_token_, kStopPatience, [](const auto&) {});
    if (news.state == State::kLatched || news.state == State::kActed) return;
    ClientOptions options = options_;
    options.role = Role::kObserver;
    Client session(address_, options);
    session.part(part).set_parameter(protocol::kEmergencyStop, true);
  });
}

std::string Plant::set_parameter(std::size_t part, const std::string& name, const ParameterValue& value) {
  if (name == protocol::kEmergencyStop && value == ParameterValue(true)) {  // anybody may stop, at any time
    return stop(parts_.at(part).name());
  }
  return under_lease(part, [&](Part& target) { target.set_parameter(name, value); });
}

std::string Plant::override_module(const protocol::OverrideModulePort& wanted) {
  return refusal_of([&] { ClientAccess::request(client_, wanted); });
}

std::string Plant::set_module_parameter(const protocol::SetModuleParameter& wanted) {
  return refusal_of([&] { ClientAccess::request(client_, wanted); });
}

protocol::ModuleList Plant::modules(std::uint64_t known_revision) {
  auto reply = ClientAccess::request(client_, protocol::ListModules{{}, known_revision});
  if (auto* list = std::get_if<protocol::ModuleList>(&reply)) return std::move(*list);
  throw Error(ErrorCode::kMalformed, "the server answered with a message of another kind");
}

std::string Plant::write_blackboard(std::size_t part, const std::string& name,
                                    std::span<const std::byte> data) {
  return under_lease(part, [&](Part& target) { target.write_blackboard(name, data); });
}

}  // namespace visum::bridge
