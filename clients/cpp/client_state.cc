#include "clients/cpp/client_state.h"

#include <algorithm>
#include <iterator>

namespace visum::detail {

ClientState& PartState::connected() const {
  if (client == nullptr) throw Error(ErrorCode::kConnection, "the part's client is gone", name);
  return *client;
}

void PartState::apply(const protocol::PartSample& sample) {
  if (sample.sensor_outputs.size() != output_ports.size() ||
      sample.controller_inputs.size() != input_ports.size()) {
    throw Error(ErrorCode::kMalformed, "the server sent a sample of another length than the part's", name);
  }
  outputs = sample.sensor_outputs;
  // Under our lease only we write, and a sample may be older than our last write. A new era begins with its
  // own values.
  if (!leased || sample.era != era) forget_writes();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!set[i]) inputs[i] = sample.controller_inputs[i];
  }
  tick = sample.tick;
  time_ns = sample.sim_time_ns;
  era = sample.era;
}

std::size_t PartState::end_of_run(std::size_t first) const {
  std::size_t end = first + 1;
  for (std::size_t port = end; port < inputs.size() && (set[port] || staged[port]); ++port) {
    if (staged[port]) end = port + 1;
  }
  return end;
}

void PartState::end_lease() {
  leased = false;
  forget_writes();
}

void PartState::forget_writes() {
  inputs.resize(input_ports.size());
  for (auto* flags : {&set, &staged, &last_write}) flags->assign(input_ports.size(), false);
}

std::vector<std::string> PartState::next_blackboards() {
  std::vector<std::string> steady;
  std::ranges::set_intersection(boards_read, boards_read_before, std::back_inserter(steady));
  boards_read_before = std::exchange(boards_read, {});
  boards.clear();
  return steady;
}

protocol::Connection& ClientState::link() {
  if (!connection) throw Error(ErrorCode::kConnection, "the connection was dropped");
  return *connection;
}

protocol::Reply ClientState::wait(std::uint64_t id) try {
  return link().wait(id);
} catch (const protocol::RequestError& refusal) {
  return protocol::Error{refusal.code(), refusal.what(), refusal.owner()};
} catch (const protocol::ConnectionError& error) {
  throw Error(ErrorCode::kConnection, error.what());
}

protocol::Reply ClientState::request(const protocol::Request& request, const std::string& part,
                                     const std::string& port) try {
  ++requests;
  return link().request(request);
} catch (const protocol::RequestError& refusal) {
  throw to_error(refusal, part, port);
} catch (const protocol::ConnectionError& error) {
  throw Error(ErrorCode::kConnection, error.what(), part, port);
}

void ClientState::post(const PartState& part, protocol::Write write) {
  if (pending.size() >= kMaxPending) {
    if (auto refusal = settle_oldest()) throw *refusal;
  }
  ++requests;
  try {
    // No tick comes before this member's next Advance, which takes the write along.
    const auto id = holds_world ? link().send_along(write) : link().send(write);
    pending.push_back({id, part.name, write.first_port, write.values.size()});
  } catch (const protocol::ConnectionError& error) {
    throw Error(ErrorCode::kConnection, error.what(), part.name);
  }
}

std::optional<Error> ClientState::settle_oldest() {
  const PendingWrite oldest = std::move(pending.front());
  pending.pop_front();
  const protocol::Reply reply = wait(oldest.id);
  const auto* refusal = std::get_if<protocol::Error>(&reply);
  if (refusal == nullptr) return std::nullopt;
  disown(oldest);
  return to_error(*refusal, oldest.part);
}

void ClientState::disown(const PendingWrite& refused) {
  for (PartState* part : parts) {
    if (part->name != refused.part) continue;
    for (std::size_t i = refused.first_port; i < refused.first_port + refused.count; ++i) {
      part->set[i] = part->staged[i];
    }
  }
}

std::optional<Error> ClientState::settle() {
  std::optional<Error> first;
  while (!pending.empty()) {
    auto refusal = settle_oldest();
    if (!first) first = std::move(refusal);
  }
  return first;
}

void ClientState::throw_refusals() {
  if (auto refusal = settle()) throw *refusal;
}

void ClientState::set_time(std::int64_t new_tick, std::int64_t new_time_ns, std::uint64_t new_era) {
  tick = new_tick;
  time_ns = new_time_ns;
  era = new_era;
}

std::vector<std::uint64_t> ClientState::send_with_reads(std::vector<protocol::Request> messages,
                                                        std::span<const protocol::ReadBlackboard> boards) {
  for (const PartState* part : parts) messages.push_back(protocol::Read{part->name});
  messages.insert(messages.end(), boards.begin(), boards.end());
  try {
    return link().send_together(messages);
  } catch (const protocol::ConnectionError& error) {
    throw Error(ErrorCode::kConnection, error.what());
  }
}

// Everything leaves together, so that a period costs one wait: the answers to the writes are there when
// Advanced comes.
void ClientState::begin_advance(std::int64_t ticks) {
  if (!advancing.empty()) throw Error(ErrorCode::kMisuse, "an advance is under way already");
  advancing_boards.clear();
  if (holds_world)
    for (PartState* part : parts)
      for (const std::string& name : part->next_blackboards())
        advancing_boards.push_back({part->name, name, 0, 0});
  advancing = send_with_reads({protocol::Advance{ticks}}, advancing_boards);
}

void ClientState::read_all() {
  throw_refusals();
  ++requests;
  const auto ids = send_with_reads({}, {});
  std::vector<protocol::Reply> samples;
  for (const auto id : ids) samples.push_back(wait(id));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    take_sample(*parts[i], std::move(samples[i]));
    parts[i]->fresh = false;
    set_time(parts[i]->tick, parts[i]->time_ns, parts[i]->era);
  }
}

void ClientState::advance(std::int64_t ticks) {
  begin_advance(ticks);
  finish_advance(wait(advancing.front()));
}

bool ClientState::advanced(std::chrono::milliseconds patience) {
  if (advancing.empty()) throw Error(ErrorCode::kMisuse, "no advance is under way");
  std::optional<protocol::Reply> reply;
  try {
    reply = link().wait_for(advancing.front(), patience);
  } catch (const protocol::RequestError& refusal) {
    reply = protocol::Error{refusal.code(), refusal.what(), refusal.owner()};
  } catch (const protocol::ConnectionError& error) {
    throw Error(ErrorCode::kConnection, error.what());
  }
  if (reply) finish_advance(*reply);
  return reply.has_value();
}

// All answers are read before anything is thrown, so that none is left over for the next period.
void ClientState::finish_advance(const protocol::Reply& reply) {
  const auto ids = std::exchange(advancing, {});
  const std::optional<Error> refusal = settle();
  std::vector<protocol::Reply> samples;
  for (std::size_t i = 1; i < ids.size(); ++i) samples.push_back(wait(ids[i]));

  if (const auto* error = std::get_if<protocol::Error>(&reply)) {
    holds_world = false;  // the server may have dropped this member: it drops members that come too late
    throw explain(*error);
  }
  const auto now = as<protocol::Advanced>(reply);
  set_time(now.tick, now.sim_time_ns, now.era);
  const std::size_t first_board = samples.size() - advancing_boards.size();
  for (std::size_t i = 0; i < advancing_boards.size(); ++i)
    take_blackboard(advancing_boards[i], std::move(samples[first_board + i]));
  for (std::size_t i = 0; i < parts.size(); ++i) take_sample(*parts[i], std::move(samples[i]));
  if (refusal) throw *refusal;
}

// An event has told a member that it was dropped from the lockstep. Its text is the better reason.
Error ClientState::explain(const protocol::Error& refusal) {
  while (const auto message = link().next(std::chrono::milliseconds(0))) {
    const auto* event = std::get_if<protocol::Event>(&*message);
    if (event != nullptr && event->kind == "lockstep_timeout") return Error(ErrorCode::kTimeout, event->text);
  }
  return to_error(refusal);
}

void ClientState::take_sample(PartState& part, protocol::Reply reply) {
  if (const auto* error = std::get_if<protocol::Error>(&reply)) throw to_error(*error, part.name);
  part.apply(as<protocol::PartSample>(std::move(reply)));
  part.fresh = true;
}

// A blackboard that cannot be read is asked for again, and then refused, where the program reads it.
void ClientState::take_blackboard(const protocol::ReadBlackboard& board, protocol::Reply reply) {
  auto* data = std::get_if<protocol::BlackboardData>(&reply);
  if (data == nullptr || !holds_world) return;
  for (PartState* part : parts)
    if (part->name == board.part) part->boards[board.name] = std::move(data->data);
  brought_at = requests;
}

std::vector<std::byte> ClientState::read_blackboard(PartState& part, const std::string& name) {
  part.boards_read.insert(name);
  // A second read asks, since other clients may have changed something.
  if (auto brought = part.boards.extract(name); !brought.empty() && requests == brought_at)
    return std::move(brought.mapped());
  return std::move(
      request_as<protocol::BlackboardData>(protocol::ReadBlackboard{part.name, name, 0, 0}, part.name, name)
          .data);
}

}  // namespace visum::detail
