#include <algorithm>
#include <cmath>
#include <thread>

#include "clients/cpp/client_state.h"
#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"
#include "protocol/limits.h"
#include "protocol/token_file.h"

namespace visum {
namespace {

using Clock = std::chrono::steady_clock;

std::string read_token(const ClientOptions& options) try {
  return protocol::read_token_file(options.token_file, static_cast<protocol::Role>(options.role));
} catch (const std::runtime_error& error) {
  throw Error(ErrorCode::kUnauthenticated, error.what());
}

std::pair<std::string, std::uint16_t> parse(const std::string& address) try {
  return protocol::parse_address(address);
} catch (const std::invalid_argument& error) {
  throw Error(ErrorCode::kMisuse, error.what());
}

// Tries until something listens or the time is over. The pauses between the attempts double, up to 0.5 s.
protocol::Connection connect(const std::string& address, const protocol::Hello& hello,
                             std::chrono::milliseconds patience, const protocol::TlsFiles& tls) {
  const auto [host, port] = parse(address);
  const auto give_up = Clock::now() + patience;
  for (auto pause = std::chrono::milliseconds(10);;
       pause = std::min(pause * 2, std::chrono::milliseconds(500))) {
    try {
      return protocol::Connection(host, port, hello, std::chrono::seconds(5), tls);
    } catch (const protocol::RequestError& refusal) {
      throw detail::to_error(refusal);
    } catch (const protocol::ConnectionError& error) {
      if (Clock::now() + pause > give_up) throw Error(ErrorCode::kConnection, error.what());
    }
    std::this_thread::sleep_for(pause);
  }
}

std::vector<PortInfo> to_ports(const std::vector<protocol::Port>& ports) {
  std::vector<PortInfo> infos;
  for (const protocol::Port& port : ports) {
    infos.push_back(
        {infos.size(), port.name, port.unit, port.group, port.minimum, port.maximum, port.initial});
  }
  return infos;
}

}  // namespace

Client::Client(const std::string& address, const ClientOptions& options)
    : state_(std::make_unique<detail::ClientState>()) {
  protocol::Hello hello{protocol::kProtocolVersion, protocol::kProtocolVersion, options.name,
                        static_cast<protocol::Role>(options.role), read_token(options)};
  protocol::TlsFiles tls{options.tls_ca, options.tls_cert, options.tls_key};
  if (!tls.given()) tls = protocol::tls_files_of_environment();
  state_->connection.emplace(connect(address, hello, options.connect_timeout, tls));
  const protocol::Welcome& welcome = state_->connection->welcome();
  state_->server = {welcome.server, welcome.scene, welcome.clock, welcome.tick_ns, welcome.simulated};
  if (welcome.tick_ns <= 0) throw Error(ErrorCode::kMalformed, "the server's tick is not longer than 0 ns");
}

Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}
Client::~Client() {
  if (!state_) return;
  for (detail::PartState* part : state_->parts) part->client = nullptr;
}

const ServerInfo& Client::server() const {
  return state_->server;
}

std::vector<std::string> Client::part_names() {
  std::vector<std::string> names;
  for (auto& part : state_->request_as<protocol::PartList>(protocol::ListParts{}).parts) {
    names.push_back(std::move(part.name));
  }
  return names;
}

Part Client::part(const std::string& name) {
  const std::vector<std::string> names = part_names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw Error(ErrorCode::kUnknownName, config::unknown_name("part", name, names), name);
  const auto reply = state_->request_as<protocol::PartDescriptionReply>(protocol::DescribePart{name}, name);
  auto part = std::make_unique<detail::PartState>();
  part->client = state_.get();
  part->name = name;
  part->kind = reply.description.kind;
  part->input_ports = to_ports(reply.description.controller_inputs);
  part->output_ports = to_ports(reply.description.sensor_outputs);
  for (const protocol::Blackboard& board : reply.description.blackboards) {
    part->blackboards.push_back(
        {board.name, board.content_type, board.element_size, board.elements, board.capacity, board.writable});
  }
  part->forget_writes();
  part->apply(state_->request_as<protocol::PartSample>(protocol::Read{name}, name));
  state_->parts.push_back(part.get());
  return Part(std::move(part));
}

void Client::join(std::chrono::milliseconds timeout) {
  const auto wall_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout).count();
  const auto now = state_->request_as<protocol::Advanced>(protocol::Join{wall_ns});
  state_->set_time(now.tick, now.sim_time_ns, now.era);
  state_->ahead_ns = 0;
  state_->holds_world = state_->server.clock == "lockstep";
}

void Client::leave() {
  state_->holds_world = false;  // even if the request fails: the server may have dropped this member already
  state_->request(protocol::Leave{});
  state_->throw_refusals();
}

namespace {

// The ticks from now to the first one at or after the end of the period.
std::int64_t ticks_of(detail::ClientState& state, std::int64_t period_ns) {
  if (period_ns <= 0) throw Error(ErrorCode::kMisuse, "a period must be longer than 0 ns");
  const std::int64_t tick_ns = state.server.tick_ns;
  const std::int64_t missing_ns = period_ns - state.ahead_ns;
  const std::int64_t ticks = missing_ns > 0 ? (missing_ns + tick_ns - 1) / tick_ns : 0;
  state.ahead_ns = ticks * tick_ns - missing_ns;
  return ticks;
}

}  // namespace

void Client::advance_ns(std::int64_t period_ns) {
  if (const std::int64_t ticks = ticks_of(*state_, period_ns); ticks > 0) state_->advance(ticks);
}

void Client::begin_advance_ns(std::int64_t period_ns) {
  std::int64_t ticks = ticks_of(*state_, period_ns);
  if (ticks == 0) {  // the last period was longer by more than this one: advanced() needs a tick to wait for
    ticks = 1;
    state_->ahead_ns += state_->server.tick_ns;
  }
  state_->begin_advance(ticks);
}

bool Client::advanced(std::chrono::milliseconds patience) {
  return state_->advanced(patience);
}

void Client::advance_ms(double period_ms) {
  if (!(period_ms > 0.0 && period_ms < 1e12)) {
    throw Error(ErrorCode::kMisuse, "a period must be a number of milliseconds above 0");
  }
  advance_ns(std::max<std::int64_t>(1, std::llround(period_ms * 1e6)));
}

void Client::advance_ticks(std::int64_t ticks) {
  if (ticks <= 0) throw Error(ErrorCode::kMisuse, "an advance must be at least one tick");
  advance_ns(ticks * state_->server.tick_ns);
}

void Client::read() {
  state_->read_all();
}

void Client::set_module_parameter(const std::string& part, const std::string& module, const std::string& name,
                                  const ParameterValue& value) {
  state_->request_as<protocol::Ok>(protocol::SetModuleParameter{part, module, name, value});
}

void Client::hold_sensor_input(const std::string& part, const std::string& module, const std::string& port,
                               std::optional<double> value) {
  state_->request_as<protocol::Ok>(
      protocol::OverrideModulePort{part, module, port, value.value_or(0.0), !value.has_value()});
}

std::int64_t Client::time_ns() const {
  return state_->time_ns;
}
std::int64_t Client::tick() const {
  return state_->tick;
}
std::uint64_t Client::era() const {
  return state_->era;
}

}  // namespace visum
