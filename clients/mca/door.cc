#include "clients/mca/door.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "clients/mca/part.h"
#include "protocol/config/number_text.h"
#include "protocol/config/unknown_name.h"

namespace visum::mca {

using Code = protocol::ErrorCode;
using std::chrono::milliseconds;

namespace {

constexpr std::uint32_t kSampleStream = 1;
constexpr const char* kAskTheServer = "ask the Visum server that the controller is connected to";
constexpr double kFar = 1e15;  // MCA2 knows no ranges; a port takes every number up to here

protocol::ListenOptions listen_options(int port) {
  protocol::ListenOptions options;
  options.port = static_cast<std::uint16_t>(port);
  options.limits.max_sessions = 32;
  return options;
}

std::vector<protocol::Port> describe(const Vector& vector) {
  std::vector<protocol::Port> ports;
  for (const auto& name : vector.names()) ports.push_back({name, "", -kFar, kFar, 0.0, ""});
  return ports;
}

void add_parameters(Module& module, std::vector<ParameterBase*>& to) {
  to.insert(to.end(), module.parameters().begin(), module.parameters().end());
  if (auto* group = dynamic_cast<Group*>(&module))
    for (const auto& member : group->members()) add_parameters(*member, to);
}

}  // namespace

Door::Door(Part& part, int port, bool lockstep, bool simulated, Hooks hooks)
    : part_(part),
      lockstep_(lockstep),
      simulated_(simulated),
      hooks_(std::move(hooks)),
      commands_(part.controller_input().values()),
      outputs_(part.sensor_output().values()),
      server_(std::make_unique<protocol::Server>(listen_options(port), *this)) {
  server_->start();
}

Door::~Door() = default;

// ---------------------------------------- the part's side

void Door::publish(std::int64_t cycle, std::int64_t time_ns) {
  cycle_ = cycle;
  time_ns_ = time_ns;
  outputs_ = part_.sensor_output().values();
  waiting_since_ = Clock::now();
  for (auto& [id, peer] : peers_) {
    if (peer.advancing && peer.granted <= cycle_) done(peer, *std::exchange(peer.advancing, {}), now());
    work_off(peer);
    if (!peer.every || cycle_ - peer.sampled < *peer.every) continue;
    peer.sampled = cycle_;
    peer.session->send_latest(kSampleStream, sample());
  }
  if (holder_ != 0 && deadline_ns_ > 0 && time_ns_ - written_ns_ > deadline_ns_)
    lost_ = "'" + holder_name_ + "' has missed its deadline";
}

std::size_t Door::members() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(peers_, [](const auto& entry) { return entry.second.joined; }));
}

std::string Door::missing_members() const {
  std::vector<std::string> joined;
  for (const auto& [id, peer] : peers_)
    if (peer.joined) joined.push_back(peer.session->client_name());
  std::string missing;
  const Options& options = part_.options();
  for (const auto& name : options.upper_names)
    if (std::ranges::find(joined, name) == joined.end())
      missing += (missing.empty() ? "'" : ", '") + name + "'";
  if (!options.upper_names.empty() || joined.size() >= static_cast<std::size_t>(options.uppers))
    return missing;
  missing = std::to_string(static_cast<std::size_t>(options.uppers) - joined.size()) + " of " +
            std::to_string(options.uppers);
  for (const auto& name : joined) missing += (name == joined.front() ? "; there is '" : ", '") + name + "'";
  return missing;
}

bool Door::is_complete() {
  const auto waited = Clock::now() - *waiting_since_;
  if (!all_have_joined_) {
    const double limit_s = part_.options().join_timeout_s;
    const std::string missing = missing_members();
    if (!missing.empty() && std::chrono::duration<double>(waited).count() > limit_s)
      throw UpperLost("these parts above have not joined within " + config::number_text(limit_s) +
                      " s (--join-timeout): " + missing);
    if (!missing.empty()) return false;
    all_have_joined_ = true;
    waiting_since_ = Clock::now();  // the cycle's time begins now
    return is_complete();
  }
  for (const auto& [id, peer] : peers_) {
    if (!peer.joined || peer.granted > cycle_) continue;
    if (waited > peer.patience)
      throw UpperLost("'" + peer.session->client_name() + "' has not come to cycle " +
                      std::to_string(cycle_) + " in time");
    return false;
  }
  return true;
}

void Door::serve(std::chrono::nanoseconds at_most) {
  if (at_most.count() > 0)
    server_->poll_for(at_most);
  else
    server_->poll();
  if (!lost_.empty()) throw UpperLost(lost_);
}

void Door::take_commands() {
  for (std::size_t i = 0; i < commands_.size(); ++i) part_.controller_input().at(i) = commands_[i];
}

template <typename Order>
void Door::relay_up(const Order& order) {
  protocol::ModuleBoard::Refusal refusal;
  if (const auto session = board_.target_of(order, refusal)) peers_.at(*session).session->send(0, order);
}

void Door::pass_up(const protocol::OverrideModulePort& wanted) {
  relay_up(wanted);
}

void Door::pass_up(const protocol::SetModuleParameter& wanted) {
  relay_up(wanted);
}

void Door::close() {
  server_->stop();
  const auto give_up = Clock::now() + milliseconds(500);
  while (!server_->ended() && Clock::now() < give_up) server_->poll_for(milliseconds(10));
}

// ---------------------------------------- sessions

protocol::Role Door::on_hello(protocol::Session& session, const protocol::Hello& hello,
                              protocol::Welcome& welcome, protocol::Error&) {
  welcome.server = part_.name() + " " VISUM_VERSION;
  welcome.tick_ns = part_.options().period_ns;
  welcome.scene = part_.name();
  welcome.clock = lockstep_ ? "lockstep" : "realtime";
  welcome.simulated = simulated_;
  peers_[session.id()].session = &session;
  return hello.role;
}

void Door::on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) {
  Peer& peer = peers_.at(session.id());
  if (!peer.advancing && peer.backlog.empty()) return dispatch(peer, id, request);
  const std::size_t bytes = session.request_bytes();
  if (const auto why = peer.backlog.refuse(bytes); !why.empty()) return fail(peer, id, Code::kBusy, why);
  peer.backlog.push({id, request, bytes});
}

void Door::work_off(Peer& peer) {
  while (!peer.advancing && !peer.backlog.empty() && !peer.session->behind()) {
    const auto [id, request, bytes] = peer.backlog.take();
    dispatch(peer, id, request);
  }
}

void Door::on_close(protocol::Session& session, protocol::CloseReason) {
  Peer& peer = peers_.at(session.id());
  peer.advancing.reset();
  while (!peer.backlog.empty()) {
    const auto [id, request, bytes] = peer.backlog.take();
    if (!std::holds_alternative<protocol::Advance>(request)) dispatch(peer, id, request);
  }
  if (holder_ == session.id()) lost_ = "'" + session.client_name() + "' is gone without a release";
  for (const auto& part : board_.forget(session.id())) hooks_.pass_down(protocol::AnnounceModules{part});
  peers_.erase(session.id());
}

void Door::dispatch(Peer& peer, std::uint64_t id, const protocol::Request& request) {
  std::visit([&](const auto& message) { handle(peer, id, message); }, request);
}

void Door::done(Peer& peer, std::uint64_t id, const protocol::Reply& reply) {
  if (id != 0) peer.session->send(id, reply);
}

void Door::fail(Peer& peer, std::uint64_t id, Code code, const std::string& text, const std::string& owner) {
  peer.session->send(id, protocol::Error{code, text, owner});
}

bool Door::is_ours(Peer& peer, std::uint64_t id, const std::string& part) {
  if (part == part_.name()) return true;
  fail(peer, id, Code::kUnknownName, config::unknown_name("part", part, {part_.name()}));
  return false;
}

bool Door::may_command(Peer& peer, std::uint64_t id) {
  if (peer.session->role() >= protocol::Role::kController) return true;
  fail(peer, id, Code::kForbidden, "this needs the role controller");
  return false;
}

bool Door::has_lease(Peer& peer, std::uint64_t id) {
  if (holder_ == peer.session->id()) return true;
  const std::string who = holder_ == 0 ? "nobody" : "'" + holder_name_ + "'";
  fail(peer, id, Code::kNoLease, "'" + part_.name() + "' is leased by " + who, holder_name_);
  return false;
}

// ---------------------------------------- requests

void Door::handle(Peer& peer, std::uint64_t id, const protocol::Status&) {
  protocol::ServerStatus status;
  status.tick = cycle_;
  status.sim_time_ns = time_ns_;
  status.era = 1;
  status.clock = lockstep_ ? "lockstep" : "realtime";
  status.sessions = static_cast<std::uint32_t>(peers_.size());
  for (const auto& [other_id, other] : peers_)
    if (other.joined) status.lockstep.push_back({other.session->client_name(), other.granted, 0, 4, {}});
  done(peer, id, status);
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::ListParts&) {
  done(peer, id, protocol::PartList{{{part_.name(), "mca_part", holder_name_}}});
}

protocol::PartDescription Door::description() const {
  protocol::PartDescription description{part_.name(), "mca_part", describe(part_.controller_input()),
                                        describe(part_.sensor_output())};
  std::vector<ParameterBase*> parameters;
  add_parameters(part_, parameters);
  for (const ParameterBase* parameter : parameters)
    description.parameters.push_back(parameter->description());
  for (const Blackboard* board : part_.blackboards()) description.blackboards.push_back(board->description());
  return description;
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::DescribePart& request) {
  if (is_ours(peer, id, request.part))
    done(peer, id, protocol::PartDescriptionReply{description(), holder_name_});
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::AcquireLease& request) {
  const auto session = peer.session->id();
  if (!may_command(peer, id) || !is_ours(peer, id, request.part)) return;
  if (request.deadline_ns < 0) return fail(peer, id, Code::kBadValue, "deadline_ns must not be negative");
  const bool may_take = request.take && peer.session->role() == protocol::Role::kAdmin;
  if (holder_ != 0 && holder_ != session && !may_take)
    return fail(peer, id, Code::kLeased, "'" + part_.name() + "' is leased by '" + holder_name_ + "'",
                holder_name_);
  holder_ = session;
  holder_name_ = peer.session->client_name();
  deadline_ns_ = request.deadline_ns;
  written_ns_ = time_ns_;
  done(peer, id, protocol::LeaseGrant{part_.name(), ++epoch_});
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::ReleaseLease& request) {
  if (!is_ours(peer, id, request.part) || !has_lease(peer, id)) return;
  holder_ = 0;
  holder_name_.clear();
  done(peer, id);
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::Write& request) {
  if (!is_ours(peer, id, request.part) || !has_lease(peer, id)) return;
  if (request.first_port > commands_.size() || request.values.size() > commands_.size() - request.first_port)
    return fail(peer, id, Code::kBadValue,
                "'" + part_.name() + "' has " + std::to_string(commands_.size()) + " controller inputs");
  for (std::size_t i = 0; i < request.values.size(); ++i)
    if (!(std::abs(request.values[i]) <= kFar))
      return fail(
          peer, id, Code::kBadValue,
          "'" + part_.controller_input().names()[request.first_port + i] + "' must be a finite number");
  std::ranges::copy(request.values, commands_.begin() + request.first_port);
  written_ns_ = time_ns_;
  done(peer, id);
}

protocol::PartSample Door::sample() const {
  return {part_.name(), cycle_, time_ns_, 1, commands_, outputs_, 0};
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::Read& request) {
  if (is_ours(peer, id, request.part)) done(peer, id, sample());
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::Subscribe& request) {
  if (!is_ours(peer, id, request.part)) return;
  if (request.every_n_ticks == 0) return fail(peer, id, Code::kBadValue, "every_n_ticks must be at least 1");
  peer.every = request.every_n_ticks;
  peer.sampled = cycle_;
  done(peer, id);
  peer.session->send_latest(kSampleStream, sample());
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::Unsubscribe& request) {
  if (!is_ours(peer, id, request.part)) return;
  if (!peer.every) return fail(peer, id, Code::kWrongState, "this session has not subscribed");
  peer.every.reset();
  done(peer, id);
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::GetParameters& request) {
  if (is_ours(peer, id, request.part)) done(peer, id, protocol::ParameterList{description().parameters});
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::SetParameter& request) {
  if (!is_ours(peer, id, request.part)) return;
  if (peer.session->role() < protocol::Role::kAdmin && !has_lease(peer, id)) return;
  std::vector<ParameterBase*> parameters;
  add_parameters(part_, parameters);
  std::vector<std::string> names;
  for (ParameterBase* parameter : parameters) {
    names.push_back(parameter->description().name);
    if (names.back() != request.name) continue;
    const std::string why = parameter->set(request.value);
    return why.empty() ? done(peer, id) : fail(peer, id, Code::kBadValue, why);
  }
  fail(peer, id, Code::kUnknownName, config::unknown_name("parameter", request.name, names));
}

protocol::Advanced Door::now() const {
  return {cycle_, time_ns_, 1};
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::Join& request) {
  if (!may_command(peer, id)) return;
  if (peer.joined) return fail(peer, id, Code::kWrongState, "this session has joined already");
  if (request.gate || request.timeout_ns < 0)
    return fail(peer, id, Code::kBadValue, "a part takes no gate, and no negative time-out");
  peer.joined = true;
  had_members_ = true;
  peer.granted = cycle_;
  peer.patience = request.timeout_ns > 0
                      ? std::chrono::nanoseconds(request.timeout_ns)
                      : std::chrono::duration_cast<Clock::duration>(
                            std::chrono::duration<double>(part_.options().upper_timeout_s));
  done(peer, id, now());
}

// In lockstep a cycle follows the last one that was asked for; else a late peer starts anew from now.
void Door::handle(Peer& peer, std::uint64_t id, const protocol::Advance& request) {
  if (!peer.joined) return fail(peer, id, Code::kWrongState, "Advance needs Join first");
  if (request.follow_buses || request.members != 0 || request.ticks < 1 || request.ticks > 1'000'000'000)
    return fail(peer, id, Code::kBadValue, "a part only goes on by 1 to 1e9 cycles");
  if (!lockstep_) peer.granted = std::max(peer.granted, cycle_);
  peer.granted += request.ticks;
  peer.advancing = id;
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::Leave&) {
  if (!peer.joined) return fail(peer, id, Code::kWrongState, "this session has not joined");
  peer.joined = false;
  done(peer, id);
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::AnnounceModules& request) {
  if (!may_command(peer, id)) return;
  if (const auto refusal = board_.announce(peer.session->id(), peer.session->client_name(), request))
    return fail(peer, id, refusal->first, refusal->second);
  hooks_.pass_down(request);
  done(peer, id);
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::ReportModules& request) {
  if (const auto refusal = board_.report(peer.session->id(), request))
    return fail(peer, id, refusal->first, refusal->second);
  hooks_.pass_down(request);
  done(peer, id);
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::ListModules& request) {
  if (const auto refusal = board_.check(request)) return fail(peer, id, refusal->first, refusal->second);
  done(peer, id, board_.list(request));
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::OverrideModulePort&) {
  fail(peer, id, Code::kWrongState, kAskTheServer);
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::SetModuleParameter&) {
  fail(peer, id, Code::kWrongState, kAskTheServer);
}

template <typename Other>
void Door::handle(Peer& peer, std::uint64_t id, const Other&) {
  fail(peer, id, Code::kWrongState, "this is a part of a controller, and has no world");
}

}  // namespace visum::mca
