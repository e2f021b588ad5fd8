#include "server/gateway/gateway.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "protocol/config/printable.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

template <typename Handler, typename Message>
concept Handles = requires(Handler& handler, const Call& call, const Message& message) {
  handler.handle(call, message);
};

// Calls the one of the handlers that knows this kind of request.
template <typename Message, typename... Handlers>
void hand_over(const Call& call, const Message& message, Handlers&... handlers) {
  static_assert((int{Handles<Handlers, Message>} + ...) == 1, "each kind of request has one handler");
  const auto try_one = [&](auto& handler) {
    if constexpr (Handles<std::decay_t<decltype(handler)>, Message>) handler.handle(call, message);
  };
  (try_one(handlers), ...);
}

// True if the request, once accepted, moves a value, a picture or a blackboard to or from a part.
bool exchanges_with_part(const protocol::Request& request) {
  return std::holds_alternative<protocol::Read>(request) ||
         std::holds_alternative<protocol::Write>(request) ||
         std::holds_alternative<protocol::Subscribe>(request) ||
         std::holds_alternative<protocol::ReadBlackboard>(request) ||
         std::holds_alternative<protocol::WriteBlackboard>(request) ||
         std::holds_alternative<protocol::UnlockBlackboard>(request);
}

}  // namespace

Gateway::Gateway(StaticWorld world, Tokens tokens, Mailbox& mailbox, StopLatch& stops,
                 const cycle::Pacer& pacer, Latest latest, bus::BusDoor& buses, LogTap* log)
    : world_(std::move(world)),
      tokens_(std::move(tokens)),
      mailbox_(mailbox),
      latest_(std::move(latest)),
      limiter_(world_.clock, mailbox),
      parts_(world_, mailbox, clients_, limiter_, holdup_),
      commands_(mailbox, parts_, stops),
      lockstep_(world_, mailbox, clients_, parts_, buses),
      streams_(world_),
      settings_(world_, parts_, commands_),
      time_(world_, commands_),
      bodies_(world_, mailbox, clients_, limiter_, commands_, parts_),
      placing_(mailbox, bodies_, parts_, commands_),
      faults_(world_, mailbox, limiter_, buses),
      events_(clients_, log),
      scenarios_(world_, clients_),
      modules_(clients_),
      scenes_(world_, commands_),
      server_(world_, mailbox, clients_, lockstep_, pacer, buses, parts_) {
  clients_.feed().set_world(world_.tick_ns, world_.server.substr(0, world_.server.find(' ')));
}

protocol::Role Gateway::on_hello(protocol::Session& session, const protocol::Hello& hello,
                                 protocol::Welcome& welcome, protocol::Error& refusal) {
  const auto identity = session.identity();
  const auto role = tokens_.grant(hello.token, identity, hello.role);
  if (role == protocol::Role::kUnspecified) {
    const std::string why = identity.empty() ? "the token is missing or wrong"
                                             : "neither a token nor the certificate of '" +
                                                   config::printable(identity) + "' gives a role here";
    refusal = tokens_.required() ? protocol::Error{ErrorCode::kUnauthenticated, why, {}}
                                 : protocol::Error{ErrorCode::kMalformed, "hello names no role", {}};
    session.log(protocol::LogLevel::kWarning,
                "'" + hello.client_name + "' at " + session.peer() + " is refused: " + refusal.text);
    return role;
  }
  welcome.server = world_.server;
  welcome.tick_ns = world_.tick_ns;
  welcome.scene = world_.scene;
  welcome.clock = scene::name_of(world_.clock);
  welcome.simulated = world_.simulated;
  clients_.add(session);
  streams_.add(session);
  return role;
}

void Gateway::follow_parts() {
  if (!now_->table || now_->table == world_.table) return;
  const auto before = world_.table;
  world_.use(now_->table);
  const auto changed = changed_parts(*before, *world_.table);
  parts_.follow(*before, changed, *now_);
  streams_.forget_parts(changed);
  lockstep_.forget_parts(changed);
}

void Gateway::look_at_world() {
  now_ = &latest_();
  follow_parts();
  bodies_.follow_shown_world(*now_);
}

void Gateway::on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) {
  auto* client = clients_.find(session.id());
  if (!client) return;
  mailbox_.beat();
  holdup_.look(Holdup::Clock::now());
  look_at_world();
  work_off(*client);
  const std::size_t bytes = session.request_bytes();
  if (!client->waiting && client->backlog.empty() && !is_deferred(*client, request)) {
    if (!holds(*client, id, request, bytes)) dispatch(*client, id, request);
  } else if (auto why = client->backlog.refuse(bytes); why.empty()) {
    if (is_emergency_stop(request) && world_.steering_part.empty())
      settings_.press_early(std::get<protocol::SetParameter>(request));
    client->backlog.push({id, request, bytes});
  } else {
    clients_.count_refusal();
    session.send(id, protocol::Error{ErrorCode::kBusy, std::move(why), {}});
  }
  note_next_due();
}

void Gateway::dispatch(Client& client, std::uint64_t id, const protocol::Request& request) {
  auto& session = *client.session;
  const Call call{clients_, client, session, id, *now_};
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
  const auto refused = clients_.refused();
  std::visit(
      [&](const auto& message) {
        hand_over(call, message, parts_, settings_, streams_, lockstep_, time_, bodies_, placing_, faults_,
                  events_, scenarios_, modules_, scenes_, server_);
      },
      request);
  // A command that waits for the tick is counted by finish_commands().
  if (exchanges_with_part(request) && clients_.refused() == refused && !client.waiting)
    clients_.count_exchange(session.client_name());
}

void Gateway::work_off_backlogs() {
  for (auto& [id, client] : clients_.all()) {
    release(client);
    work_off(client);
  }
}

void Gateway::work_off(Client& client) {
  while (!client.waiting && !client.backlog.empty() && !client.session->behind() &&
         !is_deferred(client, client.backlog.front().request)) {
    const auto [id, request, bytes] = client.backlog.take();
    if (!holds(client, id, request, bytes)) dispatch(client, id, request);
  }
}

void Gateway::work_off_at_goodbye(Client& client) {
  client.step_until.reset();
  while (!client.backlog.empty()) {
    const auto [id, request, bytes] = client.backlog.take();
    if (!std::holds_alternative<protocol::Advance>(request)) dispatch(client, id, request);
  }
}

bool Gateway::holds(Client& client, std::uint64_t id, const protocol::Request& request, std::size_t bytes) {
  const auto until = lockstep_.hold(*client.session, request, *now_);
  if (!until) return false;
  client.step_until = until;
  client.waiting = true;
  client.backlog.put_first({id, request, bytes});
  return true;
}

void Gateway::release(Client& client) {
  if (!client.step_until || (now_->tick < *client.step_until && now_->fault.empty())) return;
  if (client.session->behind()) return;
  client.step_until.reset();
  client.waiting = false;
  const auto [id, request, bytes] = client.backlog.take();
  dispatch(client, id, request);
}

void Gateway::on_room(protocol::Session& session) {
  auto* client = clients_.find(session.id());
  if (!client) return;
  look_at_world();
  release(*client);
  work_off(*client);
  note_next_due();
}

void Gateway::on_close(protocol::Session& session, protocol::CloseReason reason) {
  now_ = &latest_();
  follow_parts();
  const auto id = session.id();
  if (reason == protocol::CloseReason::kGoodbye) work_off_at_goodbye(clients_.at(id));
  parts_.lose_all_of(id, lockstep_.parts_commanded_by(id),
                     "'" + session.client_name() + "' is gone without a release", *now_);
  placing_.end_session(clients_.at(id));
  lockstep_.remove(id, *now_);
  streams_.remove(id);
  modules_.end_session(id);
  limiter_.forget(id);
  clients_.remove(id);
}

void Gateway::serve() {
  if (relieved_) return say_that_it_ends();
  commands_.collect();
  now_ = &latest_();
  const auto& now = *now_;
  follow_parts();
  follow_eras();
  bodies_.follow_shown_world(now);
  finish_commands();
  tell_notices();
  events_.serve(now);
  scenarios_.serve(now);
  placing_.serve();
  lockstep_.answer_advances(now);
  work_off_backlogs();
  parts_.send_late_writes(now);
  streams_.send_due(now);
  say_that_it_ends();
  note_next_due();
}

void Gateway::say_that_it_ends() {
  if (ending_.exchange(false) && now_)
    clients_.broadcast({"shutdown", "the server ends", {}, now_->era, now_->tick});
}

void Gateway::note_next_due() {
  auto due = streams_.next_due();
  if (const auto answer = lockstep_.next_answer()) due = std::min(due, *answer);
  if (parts_.has_late_writes()) due = std::min(due, now_->tick + 1);
  for (const auto& [id, client] : clients_.all())
    if (client.step_until) due = std::min(due, *client.step_until);
  next_due_.store(due, std::memory_order_relaxed);
}

// Each time that their number has doubled, so that the log stays short.
void Gateway::warn_of_limits() {
  if (!has_to_warn(now_->limited_ticks)) return;
  limits_warned_at_.store(2 * now_->limited_ticks, std::memory_order_relaxed);
  std::string bodies;
  for (const std::string& body : now_->limited_bodies) bodies += (bodies.empty() ? "'" : ", '") + body + "'";
  spdlog::warn(
      "tick {}: the work of {} ticks has met its limit so far (work_limit of the scene); {}", now_->tick,
      now_->limited_ticks,
      bodies.empty() ? "in the last one no body fell short" : "in the last one fell short: " + bodies);
}

void Gateway::follow_eras() {
  const auto& now = *now_;
  warn_of_limits();
  if (!now.fault.empty() && !frozen_) {
    ++freezes_;
    clients_.broadcast({"frozen", frozen_reason(now), {}, now.era, now.tick});
  }
  frozen_ = !now.fault.empty();
  if (now.era == clients_.known_era()) return;
  clients_.set_known_era(now.era);
  lockstep_.begin_era(now);
  parts_.begin_era(now);
  streams_.begin_era(now);
  for (auto& [id, client] : clients_.all()) {
    if (!client.step_until) continue;
    client.step_until = now.tick;
    lockstep_.begin_cycle_with(*client.session, client.backlog.front().request);
  }
  const bool loaded = std::exchange(scene_told_, now.table->scene_number) != now.table->scene_number;
  clients_.broadcast(
      {"era",
       loaded ? "the scene '" + now.table->scene + "' was loaded" : "the world was reset or restored",
       {},
       now.era,
       now.tick});
}

void Gateway::finish_commands() {
  for (const auto& command : commands_.take_collected()) {
    if (command->view) bodies_.replace_view(std::move(*command->view), *now_);
    const bool failed = std::holds_alternative<protocol::Error>(command->reply);
    if (failed) clients_.count_refusal();
    if (command->acknowledged) continue;
    auto* client = clients_.find(command->session);
    if (!failed)
      events_.tell_done(command->request, command->reply, client ? client->session->client_name() : "",
                        *now_);
    if (!client) continue;
    client->waiting = false;
    if (!failed && exchanges_with_part(command->request))
      clients_.count_exchange(client->session->client_name());
    if (command->id != 0 || failed) client->session->send(command->id, command->reply);
  }
}

void Gateway::tell_notices() {
  for (Notice notice; mailbox_.next_notice(notice);) {
    if (parts_.generation(notice.part) != notice.generation) continue;  // of a part that went meanwhile
    if (notice.kind == Notice::Kind::kPushRefused) {
      clients_.broadcast(
          {"push_refused", "too many pushes act at once", {}, clients_.known_era(), notice.tick});
    } else if (notice.kind == Notice::Kind::kFaultRefused) {
      clients_.broadcast({"fault_refused", "too many faults act at once", world_.part_name(notice.part),
                          clients_.known_era(), notice.tick});
    } else if (notice.kind == Notice::Kind::kWriteDropped) {
      parts_.forget_dropped(notice.part, *now_);
    } else {
      tell_stop(notice);
    }
  }
}

void Gateway::tell_stop(const Notice& notice) {
  const auto& part = world_.part_name(notice.part);
  if (notice.kind == Notice::Kind::kStopped) {
    stop_log_.write(protocol::LogLevel::kWarning,
                    "emergency stop of '" + part + "' at tick " + std::to_string(notice.tick));
    clients_.broadcast(
        {"emergency_stop", "an emergency stop was pulled", part, clients_.known_era(), notice.tick});
  }
  if (notice.kind == Notice::Kind::kSilent)
    spdlog::error("the sessions' thread was silent: '{}' was stopped at tick {}", part, notice.tick);
  if (notice.epoch != 0) parts_.end_missed_lease(notice, *now_);
}

void Gateway::beat() {
  mailbox_.beat();
  holdup_.look(Holdup::Clock::now());
  if (!now_) return;
  look_at_world();
  events_.serve(*now_);
  scenarios_.serve(*now_);
  if (!commands_.acknowledge_late(clients_, world_.working->border(), Commands::Clock::now())) return;
  for (auto& [id, client] : clients_.all()) work_off(client);
}

void Gateway::check_timeouts(std::int64_t tick) {
  if (now_) lockstep_.check_timeouts(tick, *now_);
}

Metrics Gateway::metrics() {
  return {server_.status(latest_()), parts_.list().parts, 0, parts_.lease_losses(), freezes_};
}

}  // namespace visum::gateway
