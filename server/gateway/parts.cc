#include "server/gateway/parts.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

std::string with_nine_digits(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", number);
  return text;
}

std::int64_t ms_of(Holdup::Clock::duration time) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
}

// Why the tick's thread took a part from its controller, after the controller's name.
std::string reason_of(Notice::Kind kind) {
  if (kind == Notice::Kind::kStopped) return "was stopped by an emergency stop";
  if (kind == Notice::Kind::kSilent) return "could not be heard: the server's sessions were held up";
  return "missed the deadline that it asked for";
}

}  // namespace

Parts::Parts(const StaticWorld& world, Mailbox& mailbox, Clients& clients, InputLimiter& limiter,
             const Holdup& holdup)
    : world_(world),
      mailbox_(mailbox),
      clients_(clients),
      limiter_(limiter),
      holdup_(holdup),
      leases_(world.parts.size()),
      stops_(world.parts.size()) {
  for (const auto* part : world_.parts) {
    auto& inputs = latched_.emplace_back();
    for (const auto& port : part->description().controller_inputs) inputs.push_back(port.initial);
  }
  for (std::size_t part = 0; part < world_.agents.size(); ++part)
    if (!world_.agents[part].empty()) leases_.grant(part, kAgentsSession, "agent " + world_.agents[part]);
}

void Parts::follow(const PartTable& before, std::span<const std::uint32_t> changed, const Published& now) {
  const auto count = world_.parts.size();
  const std::string with = before.scene_number == world_.table->scene_number ? "its model" : "its scene";
  leases_.grow(count);
  stops_.resize(count);
  latched_.resize(count);
  for (const auto part : changed) {
    late_.drop(part);
    if (leases_.of(part).session != 0) {
      const auto owner = leases_.of(part).owner;
      leases_.free(part);
      ++lease_losses_;
      clients_.broadcast({"lease_lost", "the part that '" + owner + "' commanded went with " + with,
                          before.slots[part].part->description().name, clients_.known_era(), now.tick});
    }
    stops_[part] = {};
    latched_[part] = now.parts[part].controller_inputs;
  }
}

protocol::PartList Parts::list() const {
  protocol::PartList list;
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part) {
    const auto& description = world_.parts[part]->description();
    if (!description.name.empty())
      list.parts.push_back({description.name, description.kind, leases_.of(part).owner});
  }
  return list;
}

void Parts::handle(const Call& call, const protocol::ListParts&) {
  call.reply(list());
}

void Parts::handle(const Call& call, const protocol::DescribePart& request) {
  if (const auto part = part_or_fail(call, world_, request.part))
    call.reply(protocol::PartDescriptionReply{world_.parts[*part]->description(), leases_.of(*part).owner});
}

bool Parts::lease_or_fail(const Call& call, std::uint32_t part) const {
  if (leases_.held_by(part, call.session.id())) return true;
  const auto& lease = leases_.of(part);
  call.fail(ErrorCode::kNoLease,
            "the part '" + world_.part_name(part) + "' is " +
                (lease.session == 0 ? "leased by nobody" : "leased by '" + lease.owner + "'") +
                "; acquire its lease first",
            lease.owner);
  return false;
}

void Parts::handle(const Call& call, const protocol::AcquireLease& request) {
  const auto part = part_or_fail(call, world_, request.part);
  if (!part) return;
  if (request.deadline_ns < 0) return call.fail(ErrorCode::kBadValue, "deadline_ns must not be negative");
  const auto& lease = leases_.of(*part);
  const bool others = lease.session != 0 && lease.session != call.session.id();
  if (others) {
    if (!request.take || lease.session == kAgentsSession)
      return call.fail(ErrorCode::kLeased,
                       "the part '" + request.part + "' is leased by '" + lease.owner + "'", lease.owner);
    if (call.session.role() < protocol::Role::kAdmin)
      return call.fail(ErrorCode::kForbidden, "only the role admin takes a lease from '" + lease.owner + "'",
                       lease.owner);
  }
  if (!others && !late_writes_sent_or_fail(call, *part)) return;
  auto* input = limiter_.blank_or_fail(call);
  if (!input) return;
  if (others) {
    call.session.log(protocol::LogLevel::kWarning, "'" + call.session.client_name() + "' at " +
                                                       call.session.peer() + " takes the lease of '" +
                                                       request.part + "' from '" + lease.owner + "'");
    lose_lease(*part, "taken by '" + call.session.client_name() + "'", call.now);
  }
  const auto epoch = leases_.grant(*part, call.session.id(), call.session.client_name());
  input->kind = Input::Kind::kLeaseGranted;
  input->part = *part;
  input->generation = world_.generation(*part);
  input->epoch = epoch;
  input->deadline_ticks = world_.to_ticks(request.deadline_ns);
  mailbox_.send(input);
  clients_.tell({"lease_granted", "'" + call.session.client_name() + "' has the lease", request.part,
                 clients_.known_era(), call.now.tick, protocol::EventLevel::kInfo,
                 call.session.client_name()});
  call.reply(protocol::LeaseGrant{request.part, epoch});
}

void Parts::handle(const Call& call, const protocol::ReleaseLease& request) {
  const auto part = part_or_fail(call, world_, request.part);
  if (!part || !lease_or_fail(call, *part)) return;
  send_late_writes_of(*part);  // those that find no room now are sent after the release
  // The limit per session does not count here: each release was preceded by a grant, which did count.
  auto* input = limiter_.urgent_blank_or_fail(call);
  if (!input) return;
  input->kind = Input::Kind::kLeaseReleased;
  input->part = *part;
  input->generation = world_.generation(*part);
  input->epoch = leases_.of(*part).epoch;
  mailbox_.send(input);
  leases_.free(*part);
  clients_.tell({"lease_released", "'" + call.session.client_name() + "' has released the lease",
                 request.part, clients_.known_era(), call.now.tick, protocol::EventLevel::kInfo,
                 call.session.client_name()});
  call.reply(protocol::Ok{});
}

std::optional<std::string> Parts::refuse(std::uint32_t part, const protocol::Write& request,
                                         std::vector<double>& wanted) const {
  const auto& ports = world_.parts[part]->description().controller_inputs;
  if (request.values.empty()) return "no values";
  if (request.first_port >= ports.size() || request.values.size() > ports.size() - request.first_port)
    return "ports " + std::to_string(request.first_port) + " to " +
           std::to_string(request.first_port + request.values.size() - 1) + " of " +
           std::to_string(ports.size());
  wanted = latched_[part];
  for (std::size_t i = 0; i < request.values.size(); ++i) {
    const auto& port = ports[request.first_port + i];
    const double value = request.values[i];
    if (!std::isfinite(value)) return "'" + port.name + "' must be a finite number";
    if (value < port.minimum || value > port.maximum)
      return "'" + port.name + "' must be within " + with_nine_digits(port.minimum) + " and " +
             with_nine_digits(port.maximum) + ", is " + with_nine_digits(value);
    wanted[request.first_port + i] = value;
  }
  return world_.parts[part]->refuse(wanted);
}

void Parts::handle(const Call& call, const protocol::Write& request) {
  const auto part = part_or_fail(call, world_, request.part);
  if (!part || !lease_or_fail(call, *part)) return;
  if (const auto age = holdup_.age(); age.count() > 0) {
    if (refused_late_++ == 0)
      spdlog::warn("the server did not run for {} ms: it refuses the writes that waited meanwhile",
                   ms_of(age));
    return call.fail(ErrorCode::kStale, "this write has waited for up to " + std::to_string(ms_of(age)) +
                                            " ms, since the server did not run: it is too old to be done");
  }
  std::vector<double> wanted;
  if (auto reason = refuse(*part, request, wanted)) return call.fail(ErrorCode::kBadValue, *reason);
  if (auto reason = world_.parts[*part]->refuse_now(latched_[*part], wanted))
    return call.fail(ErrorCode::kWrongState, *reason);
  if (!leases_.is_new(*part, request.sequence))
    return call.fail(ErrorCode::kStale, "sequence " + std::to_string(request.sequence) +
                                            " is not newer than " +
                                            std::to_string(leases_.of(*part).sequence));
  const auto session = call.session.id();
  Input* input = nullptr;
  // Late writes of the part go first, so that the order stays.
  if (!limiter_.has_sent_enough(session, call.now.tick) && send_late_writes_of(*part))
    input = mailbox_.blank_input();
  leases_.take_sequence(*part, request.sequence);
  std::ranges::copy(request.values, latched_[*part].begin() + request.first_port);
  if (input) {
    limiter_.count(session, call.now.tick);
    send_write(*part, request.first_port,
               static_cast<std::uint32_t>(request.first_port + request.values.size()), input);
  } else {
    late_.add(*part, request.first_port, request.values.size());
  }
  call.reply(protocol::Ok{});
}

void Parts::send_write(std::uint32_t part, std::uint32_t first_port, std::uint32_t end_port, Input* input) {
  input->kind = Input::Kind::kWrite;
  input->part = part;
  input->generation = world_.generation(part);
  input->epoch = leases_.of(part).epoch;
  input->first_port = first_port;
  input->read_at = Holdup::Clock::now();
  input->values.assign(latched_[part].begin() + first_port, latched_[part].begin() + end_port);
  mailbox_.send(input);
}

void Parts::send_late_writes(const Published& now) {
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part)
    if (late_.has(part) && !limiter_.has_sent_enough(leases_.of(part).session, now.tick))
      send_late_writes_of(part);
}

bool Parts::complete_writes() {
  if (late_.empty()) return false;
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part) send_late_writes_of(part);
  return true;
}

bool Parts::send_late_writes_of(std::uint32_t part) {
  while (late_.has(part)) {
    auto* input = mailbox_.blank_input();
    if (!input) return false;
    const auto [first_port, end_port] = late_.take_run(part);
    send_write(part, first_port, end_port, input);
  }
  return true;
}

bool Parts::late_writes_sent_or_fail(const Call& call, std::uint32_t part) {
  if (send_late_writes_of(part)) return true;
  call.fail(ErrorCode::kBusy, kTooManyInputs);
  return false;
}

void Parts::end_late_writes(std::uint32_t part) {
  send_late_writes_of(part);
  late_.drop(part);
}

bool Parts::send_before_command(const Call& call, bool need_all) {
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part) {
    if (!need_all)
      send_late_writes_of(part);
    else if (!late_writes_sent_or_fail(call, part))
      return false;
  }
  for (auto& stop : stops_) stop.tick = -1;
  return true;
}

// Values that were never done are not those that the next write changes. Late writes know their own.
void Parts::forget_dropped(std::uint32_t part, const Published& now) {
  if (!late_.has(part)) latched_[part] = now.parts[part].controller_inputs;
}

void Parts::begin_era(const Published& now) {
  for (std::uint32_t part = 0; part < latched_.size(); ++part) {
    end_late_writes(part);  // they were written after the request that began the era
    latched_[part] = now.parts[part].controller_inputs;
  }
}

std::optional<std::string> Parts::leased_to_another(const Call& call, const std::string& part) const {
  for (std::uint32_t i = 0; i < world_.parts.size(); ++i) {
    const auto& lease = leases_.of(i);
    if (world_.part_name(i) == part && lease.session != 0 && lease.session != call.session.id())
      return lease.owner;
  }
  return {};
}

void Parts::lose_all_of(std::uint64_t session, std::span<const std::uint32_t> commanded,
                        const std::string& why, const Published& now) {
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part) {
    if (leases_.held_by(part, session))
      lose_lease(part, why, now);
    else if (leases_.of(part).session == 0 && std::ranges::find(commanded, part) != commanded.end())
      stop(part, now);
  }
}

void Parts::lose_lease(std::uint32_t part, const std::string& why, const Published& now) {
  end_late_writes(part);
  stop(part, now);
  leases_.free(part);
  ++lease_losses_;
  clients_.broadcast({"lease_lost", why, world_.part_name(part), clients_.known_era(), now.tick});
}

void Parts::stop(std::uint32_t part, const Published& now) {
  const auto epoch = leases_.of(part).epoch;
  // In lockstep the world may stand while clients come and go. One stop is enough until it has moved on, or a
  // command may have changed it. Without this, such clients would fill the mailbox.
  const bool told = stops_[part].tick == now.tick && stops_[part].epoch == epoch;
  if (world_.clock == scene::ClockKind::kLockstep && told) return;
  stops_[part] = {now.tick, epoch};
  // Each loss either follows a grant, or is at most one input for each part. So the inputs that are kept back
  // for losses suffice, unless there are as many parts as those.
  auto* input = mailbox_.blank_input(true);
  if (!input) return;
  input->kind = Input::Kind::kLeaseLost;
  input->part = part;
  input->generation = world_.generation(part);
  input->epoch = epoch;
  mailbox_.send(input);
}

void Parts::end_missed_lease(const Notice& notice, const Published& now) {
  // The loss of this lease, or of a later one, has been told already.
  if (notice.epoch <= stops_[notice.part].epoch) return;
  const auto& lease = leases_.of(notice.part);
  // Where the lease ended or was granted anew before this notice came, the part has stopped all the same, so
  // clients are told in any case.
  const bool holds = lease.epoch == notice.epoch && lease.session != 0;
  clients_.broadcast({"lease_lost",
                      (holds ? "'" + lease.owner + "' " : "a lease that is over ") + reason_of(notice.kind),
                      world_.part_name(notice.part), clients_.known_era(), notice.tick});
  ++lease_losses_;
  if (lease.epoch != notice.epoch) return;
  late_.drop(notice.part);
  leases_.free(notice.part);
  // Writes that were accepted since the loss are not applied; so they are not latched either.
  latched_[notice.part] = now.parts[notice.part].controller_inputs;
}

}  // namespace visum::gateway
