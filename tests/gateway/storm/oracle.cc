#include "tests/gateway/storm/oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "protocol/codec.h"

namespace visum::storm {
namespace {

constexpr std::int64_t kStopTicks =
    1500;                         // of 1 ms: the drives' slowest stop takes 0.4 s, their brakes the rest
constexpr double kStands = 0.02;  // rad/s: a step or two of the encoders in a tick
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
constexpr std::int64_t kHashEvery = 100;  // ticks

bool are_alike(const protocol::Request& one, const protocol::Request& other) {
  std::vector<std::byte> bytes, others;
  protocol::encode_request(1, one, bytes);
  protocol::encode_request(1, other, others);
  return bytes == others;
}

}  // namespace

Oracle::Oracle(protocol::SessionHandler& judged, cycle::Simulation& simulation)
    : judged_(judged), simulation_(simulation), parts_(simulation.parts().size()) {
  simulation_.set_observer(this);
}

void Oracle::expect(bool holds, const std::string& claim) {
  if (holds || !broken_.empty()) return;
  broken_ = "tick " + std::to_string(simulation_.tick_count()) + ": not so: " + claim;
}

void Oracle::note(std::uint64_t number) {
  for (int i = 0; i < 8; ++i) digest_ = (digest_ ^ (number >> (8 * i) & 0xff)) * 0x100000001b3u;
}

std::size_t Oracle::part_of(std::string_view name) const {
  const auto parts = simulation_.parts();
  return static_cast<std::size_t>(
      std::ranges::find(parts, name,
                        [](const auto& bound) { return std::string_view(bound.part->description().name); }) -
      parts.begin());
}

// ----------------------------------------------------------------------------------------------------
// the sessions' side

protocol::Role Oracle::on_hello(protocol::Session& session, const protocol::Hello& hello,
                                protocol::Welcome& welcome, protocol::Error& refusal) {
  return judged_.on_hello(session, hello, welcome, refusal);
}

void Oracle::on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) {
  // A flipped bit made the id 0, or that of another request. Then no answer, or one of two, would tell what
  // became of this one.
  if (id == 0) return;
  auto& open = asked_[session.id()];
  const auto same = open.find(id);
  if (same != open.end() && !are_alike(same->second.front(), request)) return;
  ++counts_.requests;
  open[id].push_back(request);
  if (std::holds_alternative<protocol::Reset>(request) ||
      std::holds_alternative<protocol::RestoreSnapshot>(request)) {
    auto& before = era_requests_[{session.id(), id}];
    if (before.empty())
      for (const auto& part : parts_) before.push_back(part.gone + part.under_way.size());
  }
  judged_.on_request(session, id, request);
}

void Oracle::on_close(protocol::Session& session, protocol::CloseReason reason) {
  judged_.on_close(session, reason);
  note(session.id());
  asked_.erase(session.id());
  std::erase_if(era_requests_, [&](const auto& one) { return one.first.first == session.id(); });
  for (const auto& part : parts_) expect(part.owner != session.id(), "who is gone owns nothing");
}

void Oracle::sends(protocol::Session& session, std::uint64_t reply_to, const protocol::Reply& reply) {
  note(session.id());
  note(reply_to);
  note(reply.index());
  if (std::holds_alternative<protocol::Welcome>(reply)) return;
  if (reply_to == 0) {
    const auto* event = std::get_if<protocol::Event>(&reply);
    if (event && event->kind == "lease_lost") lost(*event);
    return;
  }
  auto& open = asked_[session.id()];
  const auto found = open.find(reply_to);
  if (found == open.end())
    return expect(false, "one answer for each request, number " + std::to_string(reply_to));
  const auto request = std::move(found->second.front());
  found->second.pop_front();
  if (found->second.empty()) {
    open.erase(found);
    era_requests_.erase({session.id(), reply_to});
  }
  if (const auto* error = std::get_if<protocol::Error>(&reply)) {
    ++counts_.refused;
    expect(error->code != protocol::ErrorCode::kInternal, "no internal error: " + error->text);
  } else {
    accepted(session, request, reply);
  }
}

void Oracle::accepted(protocol::Session& session, const protocol::Request& request,
                      const protocol::Reply& reply) {
  if (const auto* grant = std::get_if<protocol::LeaseGrant>(&reply)) {
    auto& part = parts_[part_of(grant->part)];
    expect(part.owner == 0 || part.owner == session.id(), "one owner of '" + grant->part + "'");
    expect(grant->epoch == part.epoch + 1, "epochs of '" + grant->part + "' count the grants");
    part.owner = session.id();
    part.epoch = grant->epoch;
    part.under_way.push_back({Step::Kind::kGrant, part.epoch});
  } else if (const auto* release = std::get_if<protocol::ReleaseLease>(&request)) {
    auto& part = parts_[part_of(release->part)];
    expect(part.owner == session.id(), "only its owner releases '" + release->part + "'");
    part.owner = 0;
    part.under_way.push_back({Step::Kind::kRelease, part.epoch});
  } else if (const auto* write = std::get_if<protocol::Write>(&request)) {
    auto& part = parts_[part_of(write->part)];
    ++counts_.writes;
    expect(part.owner == session.id(), "only its owner writes to '" + write->part + "'");
    part.under_way.push_back({Step::Kind::kWrite, part.epoch, write->first_port, write->values});
  }
}

// All sessions are told; only the first time counts. The world knows of a missed deadline already.
void Oracle::lost(const protocol::Event& event) {
  auto& part = parts_[part_of(event.part)];
  if (event.text.starts_with("a lease that is over"))
    return expect(part.lost_there > 0, "the world knows of a missed deadline first");
  if (part.owner == 0) return;
  part.owner = 0;
  if (event.text.find("missed the deadline") == std::string::npos)
    part.under_way.push_back({Step::Kind::kLoss, part.epoch});
  else
    expect(part.lost_there >= part.epoch, "the world knows of a missed deadline first");
}

// Some commands bring the inputs before them into the world at once. So the oracle follows while the mailbox
// is emptied.
void Oracle::empty_mailbox(gateway::TickSide& tick_side) {
  for (auto& part : parts_) part.delivered = kAll;
  tick_side.empty_mailbox();
  for (auto& part : parts_) {
    part.delivered = part.under_way.size();
    for (const auto& step : part.under_way)
      if (step.kind == Step::Kind::kGrant) part.newest_there = std::max(part.newest_there, step.epoch);
  }
}

// ----------------------------------------------------------------------------------------------------
// the world

void Oracle::took(const recording::TimedInput& input) {
  note(static_cast<std::uint64_t>(input.tick));
  note(input.input.index());
  if (const auto* write = std::get_if<recording::WriteInputs>(&input.input)) {
    took_write(parts_[part_of(write->part)], *write);
  } else if (const auto* loss = std::get_if<recording::LoseController>(&input.input)) {
    took_loss(parts_[part_of(loss->part)]);
  } else if (std::holds_alternative<recording::Reset>(input.input) ||
             std::holds_alternative<recording::RestoreSnapshot>(input.input)) {
    took_era();
  }
}

// Writes accepted before it was asked for were done before it, and are undone by it.
void Oracle::took_era() {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    auto& part = parts_[i];
    part.must_stand_from = -1;  // it may move there
    if (era_requests_.empty()) continue;
    const auto first =
        std::ranges::min_element(era_requests_, {}, [&](const auto& one) { return one.second[i]; });
    for (std::uint64_t k = part.gone; k < first->second[i]; ++k) {
      const auto& step = part.under_way[k - part.gone];
      expect(step.kind != Step::Kind::kWrite || step.epoch <= part.lost_there || is_in_force(part, step),
             "what was accepted before a reset is done before it");
    }
    for (const auto& [port, value] : part.to_come)
      expect(is_in_force(part, port, value), "all of a write is done before a reset");
    part.to_come.clear();
  }
}

std::optional<Oracle::Step> Oracle::next_step(PartModel& part) {
  if (part.delivered == 0 || part.under_way.empty()) return {};
  auto step = std::move(part.under_way.front());
  part.under_way.pop_front();
  ++part.gone;
  --part.delivered;
  if (step.kind == Step::Kind::kGrant) part.newest_there = step.epoch;
  return step;
}

void Oracle::took_write(PartModel& part, const recording::WriteInputs& write) {
  ++counts_.taken;
  std::map<std::uint32_t, double> wanted;
  for (std::size_t i = 0; i < write.values.size(); ++i)
    wanted[write.first_port + static_cast<std::uint32_t>(i)] = write.values[i];
  const auto is_all_there = [&] { return std::ranges::includes(part.to_come, wanted); };
  while (!is_all_there()) {
    const auto step = next_step(part);
    if (!step) return expect(false, "what is done was accepted, and is done once, in order");
    if (step->kind == Step::Kind::kLoss) expect(false, "a loss reaches the world before what comes after it");
    if (step->kind != Step::Kind::kWrite || step->epoch <= part.lost_there) continue;  // too late to be done
    for (std::size_t i = 0; i < step->values.size(); ++i)
      part.to_come[step->first_port + static_cast<std::uint32_t>(i)] = step->values[i];
  }
  for (const auto& [port, value] : wanted) {
    part.to_come.erase(port);
    part.in_force[port] = value;
  }
  part.must_stand_from = -1;
}

bool Oracle::is_in_force(const PartModel& part, std::uint32_t port, double value) {
  const auto found = part.in_force.find(port);
  return found != part.in_force.end() && found->second == value;
}

bool Oracle::is_in_force(const PartModel& part, const Step& write) {
  for (std::size_t i = 0; i < write.values.size(); ++i)
    if (!is_in_force(part, write.first_port + static_cast<std::uint32_t>(i), write.values[i])) return false;
  return true;
}

void Oracle::took_loss(PartModel& part) {
  ++counts_.losses;
  part.must_stand_from = simulation_.tick_count() + kStopTicks;
  while (const auto next = next_step(part)) {
    const auto& step = *next;
    if (step.kind == Step::Kind::kLoss) {
      for (const auto& [port, value] : part.to_come)
        expect(step.epoch <= part.lost_there || is_in_force(part, port, value),
               "all of a write is done before the loss of its lease");
      part.to_come.clear();
      part.lost_there = std::max(part.lost_there, step.epoch);
      return;
    }
    if (step.kind == Step::Kind::kWrite)
      expect(step.epoch <= part.lost_there || is_in_force(part, step),
             "a write is done before the loss of its lease");
  }
  part.to_come.clear();
  part.lost_there = part.newest_there;  // a deadline was missed
}

void Oracle::ticked() {
  const auto tick = simulation_.tick_count();
  expect(!simulation_.frozen(), "the world goes on: " + simulation_.fault());
  if (tick % kHashEvery == 0) note(simulation_.state_hash());
  const auto parts = simulation_.parts();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].must_stand_from < 0 || tick < parts_[i].must_stand_from) continue;
    const auto& outputs = parts[i].part->description().sensor_outputs;
    for (std::size_t port = 0; port < outputs.size(); ++port)
      if (outputs[port].name.starts_with("Actual Speed"))
        expect(std::abs(parts[i].sensor_outputs[port]) < kStands,
               "'" + outputs[port].name + "' stands after the loss of its controller");
  }
}

void Oracle::settled() {
  for (const auto& [session, open] : asked_)
    expect(false, "everybody was answered: session " + std::to_string(session) + " asked for " +
                      std::to_string(open.size()) + " things that were not");
  for (const auto& part : parts_) {
    expect(part.owner == 0, "nobody owns anything when all are gone");
    for (const auto& step : part.under_way)
      expect(step.kind != Step::Kind::kLoss && (step.kind != Step::Kind::kWrite ||
                                                step.epoch <= part.lost_there || is_in_force(part, step)),
             "what was accepted was done");
    for (const auto& [port, value] : part.to_come)
      expect(is_in_force(part, port, value), "all of what was accepted was done");
  }
}

}  // namespace visum::storm
