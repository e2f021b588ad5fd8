#include <algorithm>
#include <exception>
#include <utility>

#include "clients/cpp/client_state.h"
#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"

namespace visum {
namespace {

std::string near_port(const std::string& name, const std::vector<PortInfo>& ports) {
  std::vector<std::string> candidates;
  for (const PortInfo& port : ports) {
    candidates.push_back(port.name);
    if (!port.group.empty()) candidates.push_back(port.group);
  }
  return config::did_you_mean(name, candidates);
}

// The ports of the group `name` if `groups` is set and there is such a group, else the one port of that name.
// `vector` is for the error's text.
std::vector<std::size_t> find_ports(const detail::PartState& part, const std::vector<PortInfo>& ports,
                                    const std::string& name, const char* vector, bool groups) {
  std::vector<std::size_t> found;
  for (const PortInfo& port : ports) {
    if (groups && port.group == name) found.push_back(port.index);
  }
  if (!found.empty()) return found;
  for (const PortInfo& port : ports) {
    if (port.name == name) return {port.index};
  }
  throw Error(ErrorCode::kUnknownName,
              "part '" + part.name + "' has no " + vector + " '" + name + "'" + near_port(name, ports),
              part.name, name);
}

std::vector<std::size_t> one_port(const detail::PartState& part, const std::vector<PortInfo>& ports,
                                  std::size_t index, const char* vector) {
  if (index < ports.size()) return {index};
  throw Error(ErrorCode::kUnknownName,
              "part '" + part.name + "' has no " + vector + " of index " + std::to_string(index) +
                  "; it has " + std::to_string(ports.size()),
              part.name);
}

std::vector<std::size_t> every_port(const std::vector<PortInfo>& ports) {
  std::vector<std::size_t> indices;
  for (const PortInfo& port : ports) indices.push_back(port.index);
  return indices;
}

constexpr const char* kInput = "controller input";
constexpr const char* kOutput = "sensor output";

}  // namespace

Part::Part(std::unique_ptr<detail::PartState> state) : state_(std::move(state)) {}
Part::Part(Part&&) noexcept = default;
Part& Part::operator=(Part&& other) noexcept {
  if (this != &other) {
    let_go();
    state_ = std::move(other.state_);
  }
  return *this;
}
Part::~Part() {
  let_go();
}

void Part::let_go() noexcept {
  if (!state_ || state_->client == nullptr) return;
  detail::ClientState& client = *state_->client;
  if (state_->leased && client.connection) {
    const bool unwinding = std::uncaught_exceptions() > state_->exceptions_at_acquire;
    try {
      if (!unwinding) release();
    } catch (const Error&) {
      // The lease then ends with the connection. A destructor cannot report the error.
    }
    if (state_->leased) client.connection.reset();
  }
  std::erase(client.parts, state_.get());
}

const std::string& Part::name() const {
  return state_->name;
}
const std::string& Part::kind() const {
  return state_->kind;
}
const std::vector<PortInfo>& Part::input_ports() const {
  return state_->input_ports;
}
const std::vector<PortInfo>& Part::output_ports() const {
  return state_->output_ports;
}

Inputs Part::inputs(const std::string& group_or_name) const {
  return Inputs(*state_, find_ports(*state_, state_->input_ports, group_or_name, kInput, true));
}
Inputs Part::input(const std::string& name) const {
  return Inputs(*state_, find_ports(*state_, state_->input_ports, name, kInput, false));
}
Inputs Part::input(std::size_t index) const {
  return Inputs(*state_, one_port(*state_, state_->input_ports, index, kInput));
}
Inputs Part::all_inputs() const {
  return Inputs(*state_, every_port(state_->input_ports));
}
Outputs Part::outputs(const std::string& group_or_name) const {
  return Outputs(*state_, find_ports(*state_, state_->output_ports, group_or_name, kOutput, true));
}
Outputs Part::output(const std::string& name) const {
  return Outputs(*state_, find_ports(*state_, state_->output_ports, name, kOutput, false));
}
Outputs Part::output(std::size_t index) const {
  return Outputs(*state_, one_port(*state_, state_->output_ports, index, kOutput));
}
Outputs Part::all_outputs() const {
  return Outputs(*state_, every_port(state_->output_ports));
}

void Part::acquire(std::int64_t deadline_ns, bool take) {
  detail::ClientState& client = state_->connected();
  client.request(protocol::AcquireLease{state_->name, deadline_ns, take}, state_->name);
  state_->leased = true;
  state_->exceptions_at_acquire = std::uncaught_exceptions();
  state_->set = state_->staged;
  state_->apply(client.request_as<protocol::PartSample>(protocol::Read{state_->name}, state_->name));
}

void Part::release() {
  if (!state_->leased) return;
  detail::ClientState& client = state_->connected();
  const auto refusal = client.settle();
  try {
    client.request(protocol::ReleaseLease{state_->name}, state_->name);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kNoLease) state_->end_lease();  // it was lost before
    throw;
  }
  state_->end_lease();
  if (refusal) throw *refusal;
}

bool Part::leased() const {
  return state_->leased;
}

// Sends one message for each run of ports whose values we know. A port that was not set under this lease is
// not sent: its value comes from a sample, which may be older than the last write of the lease's former
// holder.
void Part::write() {
  detail::ClientState& client = state_->connected();
  auto& staged = state_->staged;
  if (std::find(staged.begin(), staged.end(), true) == staged.end()) staged = state_->last_write;
  for (std::size_t port = 0; port < staged.size(); ++port) {
    if (!staged[port]) continue;
    const auto end = state_->end_of_run(port);
    const auto values = std::span(state_->inputs).subspan(port, end - port);
    client.post(*state_, {state_->name, static_cast<std::uint32_t>(port), {values.begin(), values.end()}, 0});
    port = end;
  }
  state_->last_write = staged;
  staged.assign(staged.size(), false);
}

void Part::read() {
  detail::ClientState& client = state_->connected();
  if (!std::exchange(state_->fresh, false)) {
    client.throw_refusals();
    state_->apply(client.request_as<protocol::PartSample>(protocol::Read{state_->name}, state_->name));
    client.set_time(state_->tick, state_->time_ns, state_->era);
  }
}

std::int64_t Part::sample_tick() const {
  return state_->tick;
}
std::int64_t Part::sample_time_ns() const {
  return state_->time_ns;
}

std::vector<ParameterInfo> Part::parameters() const {
  const auto list = state_->connected().request_as<protocol::ParameterList>(
      protocol::GetParameters{state_->name}, state_->name);
  std::vector<ParameterInfo> infos;
  for (const protocol::Parameter& parameter : list.parameters) {
    infos.push_back({parameter.name, parameter.unit, parameter.help, parameter.value, parameter.minimum,
                     parameter.maximum, parameter.choices, parameter.read_only});
  }
  return infos;
}

ParameterValue Part::parameter(const std::string& name) const {
  std::vector<std::string> names;
  for (const ParameterInfo& parameter : parameters()) {
    if (parameter.name == name) return parameter.value;
    names.push_back(parameter.name);
  }
  throw Error(ErrorCode::kUnknownName,
              "part '" + state_->name + "': " + config::unknown_name("parameter", name, names), state_->name,
              name);
}

void Part::set_parameter(const std::string& name, const ParameterValue& value) {
  state_->connected().request(protocol::SetParameter{state_->name, name, value}, state_->name, name);
}

const std::vector<BlackboardInfo>& Part::blackboards() const {
  return state_->blackboards;
}

std::vector<std::byte> Part::read_blackboard(const std::string& name) const {
  return state_->connected().read_blackboard(*state_, name);
}

void Part::write_blackboard(const std::string& name, std::span<const std::byte> data, std::uint64_t offset) {
  state_->connected().request(
      protocol::WriteBlackboard{state_->name, name, offset, {data.begin(), data.end()}}, state_->name, name);
}

void Part::lock_blackboard(const std::string& name, std::int64_t timeout_ns) {
  state_->connected().request(protocol::LockBlackboard{state_->name, name, timeout_ns}, state_->name, name);
}

void Part::unlock_blackboard(const std::string& name, bool discard) {
  state_->connected().request(protocol::UnlockBlackboard{state_->name, name, discard}, state_->name, name);
}

}  // namespace visum
