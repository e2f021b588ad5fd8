#include "server/gateway/gateway.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace visum::gateway {

using protocol::ErrorCode;

StaticWorld static_world(const cycle::Simulation& simulation) {
  const auto& scene = simulation.scene();
  StaticWorld world{scene.name,
                    scene.clock,
                    scene.world.tick_ns,
                    std::chrono::nanoseconds(scene.lockstep_timeout_ns),
                    {},
                    {},
                    describe_world(scene, simulation.revision())};
  for (const auto& bound : simulation.parts()) {
    world.parts.push_back(bound.part.get());
    world.agents.push_back(bound.agent);
  }
  return world;
}

Gateway::Gateway(StaticWorld world, Tokens tokens, Mailbox& mailbox, const cycle::Pacer& pacer, Latest latest)
    : world_(std::move(world)),
      tokens_(std::move(tokens)),
      mailbox_(mailbox),
      pacer_(pacer),
      latest_(std::move(latest)),
      leases_(world_.parts.size()),
      stops_(world_.parts.size()) {
  for (const auto* part : world_.parts) {
    auto& inputs = latched_.emplace_back();
    for (const auto& port : part->description().controller_inputs) inputs.push_back(port.initial);
  }
  for (std::size_t part = 0; part < world_.agents.size(); ++part)
    if (!world_.agents[part].empty()) leases_.grant(part, kAgentsSession, "agent " + world_.agents[part]);
}

void Gateway::Call::reply(const protocol::Reply& reply) const {
  if (id != 0) session.send(id, reply);
}

void Gateway::Call::fail(ErrorCode code, const std::string& text, const std::string& owner) const {
  ++refused;
  if (code == ErrorCode::kForbidden)
    spdlog::warn("'{}' at {} is refused: {}", session.client_name(), session.peer(), text);
  session.send(id, protocol::Error{code, text, owner});
}

protocol::Role Gateway::on_hello(protocol::Session& session, const protocol::Hello& hello,
                                 protocol::Welcome& welcome, protocol::Error& refusal) {
  const auto identity = session.identity();
  const auto role = tokens_.grant(hello.token, identity, hello.role);
  if (role == protocol::Role::kUnspecified) {
    const std::string why =
        identity.empty() ? "the token is missing or wrong"
                         : "neither a token nor the certificate of '" + identity + "' gives a role here";
    refusal = tokens_.required() ? protocol::Error{ErrorCode::kUnauthenticated, why, {}}
                                 : protocol::Error{ErrorCode::kMalformed, "hello names no role", {}};
    spdlog::warn("'{}' at {} is refused: {}", hello.client_name, session.peer(), refusal.text);
    return role;
  }
  welcome.tick_ns = world_.tick_ns;
  welcome.scene = world_.scene;
  welcome.clock = scene::name_of(world_.clock);
  welcome.simulated = world_.simulated;
  clients_[session.id()].session = &session;
  return role;
}

void Gateway::on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) {
  const auto found = clients_.find(session.id());
  if (found == clients_.end()) return;
  now_ = &latest_();
  follow_shown_world(*now_);
  auto& client = found->second;
  work_off(client);
  if (!client.waiting && client.backlog.empty()) {
    if (!holds(client, id, request)) dispatch(client, id, request);
  } else if (client.backlog.size() < kMaxBacklog) {
    client.backlog.emplace_back(id, request);
  } else {
    ++refused_;
    session.send(
        id, protocol::Error{ErrorCode::kBusy, "too many requests behind one that waits for the world", {}});
  }
  note_due();
}

void Gateway::dispatch(Client& client, std::uint64_t id, const protocol::Request& request) {
  auto& session = *client.session;
  const Call call{session, client, id, refused_};
  const auto needed = role_needed(request);
  if (session.role() < needed)
    return call.fail(ErrorCode::kForbidden, std::string("this needs the role ") +
                                                protocol::to_string(needed) + ", the session has " +
                                                protocol::to_string(session.role()));
  if (!world_.has_world && needs_world(request)) {
    return call.fail(ErrorCode::kWrongState,
                     "there is no simulated world behind these parts: their time cannot be "
                     "held or go back, and there are no bodies to change");
  }
  if (!world_.steering_part.empty() && !leaves_recording(request, world_.steering_part))
    return call.fail(ErrorCode::kWrongState, "this is a recording: what happened in it cannot be changed");
  std::visit([&](const auto& message) { handle(call, message); }, request);
}

void Gateway::work_off_backlogs() {
  for (auto& [id, client] : clients_) {
    release(client);
    work_off(client);
  }
}

void Gateway::work_off(Client& client) {
  while (!client.waiting && !client.backlog.empty() && !client.session->behind()) {
    const auto [id, request] = std::move(client.backlog.front());
    client.backlog.pop_front();
    if (!holds(client, id, request)) dispatch(client, id, request);
  }
}

// All that it asked for before it left. Behind a command the mailbox keeps the order; ticks that are to come
// are not waited for.
void Gateway::work_off_at_goodbye(Client& client) {
  client.step_until.reset();
  while (!client.backlog.empty()) {
    const auto [id, request] = std::move(client.backlog.front());
    client.backlog.pop_front();
    if (!std::holds_alternative<protocol::Advance>(request)) dispatch(client, id, request);
  }
}

void Gateway::on_room(protocol::Session& session) {
  const auto found = clients_.find(session.id());
  if (found == clients_.end()) return;
  now_ = &latest_();
  follow_shown_world(*now_);
  release(found->second);
  work_off(found->second);
  note_due();
}

void Gateway::on_close(protocol::Session& session, protocol::CloseReason reason) {
  now_ = &latest_();
  const auto id = session.id();
  if (reason == protocol::CloseReason::kGoodbye) work_off_at_goodbye(clients_.at(id));
  lose_parts_of(id, "'" + session.client_name() + "' is gone without a release");
  leave(id);
  dropped_.erase(id);
  clients_.erase(id);
}

void Gateway::serve() {
  take_commands();
  now_ = &latest_();
  const auto& now = *now_;
  follow_eras(now);
  follow_shown_world(now);
  finish_commands();
  tell_notices();
  answer_advances(now);
  work_off_backlogs();
  send_late_writes();
  send_samples(now);
  if (ending_.exchange(false)) broadcast({"shutdown", "the server ends", {}, now.era, now.tick});
  note_due();
}

void Gateway::note_due() {
  auto due = std::numeric_limits<std::int64_t>::max();
  if (const auto answer = members_.next_answer()) due = *answer;
  if (!late_.empty()) due = std::min(due, now_->tick + 1);
  for (const auto& [id, client] : clients_) {
    if (client.step_until) due = std::min(due, *client.step_until);
    for (const auto& subscription : client.subscriptions) due = std::min(due, subscription.next_tick);
  }
  next_due_.store(due, std::memory_order_relaxed);
}

void Gateway::follow_eras(const Published& now) {
  if (!now.fault.empty() && !frozen_) {
    ++freezes_;
    broadcast({"frozen", frozen_reason(now), {}, now.era, now.tick});
  }
  frozen_ = !now.fault.empty();
  if (now.era == era_) return;
  era_ = now.era;
  members_.rebase(now.tick);
  for (std::uint32_t part = 0; part < latched_.size(); ++part) {
    end_late_writes(part);  // what came after what began the era
    latched_[part] = now.parts[part].controller_inputs;
  }
  for (auto& member : members_.all())
    if (member.gate) member.gate->restart();
  for (auto& [id, client] : clients_) {
    client.peaks_from = now.tick;
    if (client.step_until) hold_no_longer(client);
    for (auto& subscription : client.subscriptions) subscription.next_tick = now.tick;
  }
  broadcast({"era", "the world was reset or restored", {}, now.era, now.tick});
}

void Gateway::follow_shown_world(const Published& now) {
  if (now.shown == shown_) return;
  shown_ = now.shown;
  world_.view = *shown_;
  broadcast({"world_changed", "another world is shown", {}, now.era, now.tick});
}

// Before the copy of the world is taken: what stands behind these commands is answered from one that is as
// late.
void Gateway::take_commands() {
  while (auto command = mailbox_.next_done()) done_.push_back(std::move(command));
}

void Gateway::finish_commands() {
  for (const auto& command : std::exchange(done_, {})) {
    if (command->view) {
      world_.view = std::move(*command->view);
      broadcast({"world_changed", "bodies came or went", {}, now_->era, now_->tick});
    }
    if (std::holds_alternative<protocol::Error>(command->reply)) ++refused_;
    const auto client = clients_.find(command->session);
    if (client == clients_.end()) continue;
    client->second.waiting = false;
    if (command->id != 0 || std::holds_alternative<protocol::Error>(command->reply))
      client->second.session->send(command->id, command->reply);
  }
}

void Gateway::tell_notices() {
  for (Notice notice; mailbox_.next_notice(notice);) {
    if (notice.kind == Notice::Kind::kPushRefused) {
      broadcast({"push_refused", "too many pushes act at once", {}, era_, notice.tick});
    } else if (notice.kind == Notice::Kind::kFaultRefused) {
      broadcast({"fault_refused", "too many faults act at once",
                 world_.parts[notice.part]->description().name, era_, notice.tick});
    } else {
      tell_missed_deadline(notice);
    }
  }
}

// Where the lease ended or was granted anew before the word of it was there, the part has stopped all the
// same. A loss that was told before, of this lease or of a later one, is none again.
void Gateway::tell_missed_deadline(const Notice& notice) {
  if (notice.epoch <= stops_[notice.part].epoch) return;
  const auto& lease = leases_.of(notice.part);
  const bool holds = lease.epoch == notice.epoch && lease.session != 0;
  broadcast({"lease_lost",
             holds ? "'" + lease.owner + "' missed the deadline that it asked for"
                   : "a lease that is over missed the deadline that was asked for",
             world_.parts[notice.part]->description().name, era_, notice.tick});
  ++lease_losses_;
  if (lease.epoch != notice.epoch) return;
  late_.drop(notice.part);
  leases_.free(notice.part);
  // What was accepted since the loss is not done.
  latched_[notice.part] = now_->parts[notice.part].controller_inputs;
}

// What it leased, and what its program commanded by a bus, unless somebody else leases that.
void Gateway::lose_parts_of(std::uint64_t session, const std::string& why) {
  const auto* member = members_.find(session);
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part) {
    if (leases_.held_by(part, session))
      lose_lease(part, why);
    else if (member && leases_.of(part).session == 0 &&
             std::ranges::find(member->parts, part) != member->parts.end())
      stop_part(part);
  }
}

// The part is told that its controller is gone. In lockstep, where the world may stand while clients come and
// go, it is told once until the world has looked.
void Gateway::stop_part(std::uint32_t part) {
  const Stop stop{now_->tick, commands_sent_, leases_.of(part).epoch};
  if (world_.clock == scene::ClockKind::kLockstep && stops_[part] == stop) return;
  stops_[part] = stop;
  // So a loss follows a grant, or costs one input for each part: those kept back do not run out before there
  // are that many parts.
  auto* input = mailbox_.blank_input(true);
  if (!input) return;
  input->kind = Input::Kind::kLeaseLost;
  input->part = part;
  input->epoch = leases_.of(part).epoch;
  mailbox_.send(input);
}

void Gateway::lose_lease(std::uint32_t part, const std::string& why) {
  end_late_writes(part);
  stop_part(part);
  leases_.free(part);
  ++lease_losses_;
  broadcast({"lease_lost", why, world_.parts[part]->description().name, era_, now_->tick});
}

void Gateway::broadcast(const protocol::Event& event) {
  for (auto& [id, client] : clients_) client.session->send(0, event);
}

// FNV-1a of the client's name: the same number in every run.
std::uint64_t Gateway::order_of(const Call& call) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (unsigned char c : call.session.client_name()) hash = (hash ^ c) * 0x100000001b3u;
  return hash;
}

bool Gateway::has_sent_enough(Client& client) const {
  if (client.counted_tick != now_->tick) client.inputs_at_tick = 0;
  client.counted_tick = now_->tick;
  const bool realtime = world_.clock == scene::ClockKind::kRealtime;
  return client.inputs_at_tick >= (realtime ? kMaxInputsPerTick : kMaxSingleWrites);
}

Input* Gateway::input_or_fail(const Call& call) {
  if (has_sent_enough(call.client) && world_.clock == scene::ClockKind::kRealtime) {
    call.fail(ErrorCode::kBusy, "more than " + std::to_string(kMaxInputsPerTick) + " inputs within one tick");
    return nullptr;
  }
  ++call.client.inputs_at_tick;
  return blank_input_or_fail(call);
}

Input* Gateway::blank_input_or_fail(const Call& call, bool urgent) {
  auto* input = mailbox_.blank_input(urgent);
  if (!input) call.fail(ErrorCode::kBusy, kTooManyInputs);
  return input;
}

// What was written before it counts as written before it. What lets time go on, or stand, is not refused over
// that: a tick makes room.
void Gateway::send_command(const Call& call, const protocol::Request& request, std::uint32_t part) {
  const bool about_pace =
      std::holds_alternative<protocol::Pause>(request) || std::holds_alternative<protocol::Resume>(request) ||
      std::holds_alternative<protocol::SetSpeed>(request) || std::holds_alternative<protocol::Step>(request);
  for (std::uint32_t written = 0; written < world_.parts.size(); ++written) {
    if (about_pace)
      send_late_writes(written);
    else if (!late_writes_sent_or_fail(call, written))
      return;
  }
  auto command = std::make_unique<Command>(Command{call.session.id(), call.id, part, request, {}, {}});
  call.client.waiting = mailbox_.send(std::move(command));
  ++commands_sent_;
  if (!call.client.waiting) call.fail(ErrorCode::kBusy, "too many requests wait for the next tick");
}

}  // namespace visum::gateway
