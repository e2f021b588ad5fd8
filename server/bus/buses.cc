#include "server/bus/buses.h"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <utility>

#include "hwparts/powercube/module_bus.h"

namespace visum::bus {
namespace {

std::uint32_t part_index(const cycle::Simulation& simulation, const std::string& name) {
  const auto parts = simulation.parts();
  for (std::uint32_t i = 0; i < parts.size(); ++i)
    if (parts[i].part->description().name == name) return i;
  throw std::runtime_error("there is no part '" + name + "'");
}

// The only part that has modules.
std::uint32_t part_with_modules(const cycle::Simulation& simulation) {
  const auto parts = simulation.parts();
  std::vector<std::uint32_t> found;
  std::string names;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].part->modules()) continue;
    found.push_back(i);
    names += (names.empty() ? "" : ", ") + parts[i].part->description().name;
  }
  if (found.empty()) throw std::runtime_error("no part of this scene has modules that a bus could reach");
  if (found.size() > 1) throw std::runtime_error("several parts have modules; name one of them: " + names);
  return found.front();
}

std::unique_ptr<BusLink> open(const BusAddress& address) {
  const auto kinds = bus_kinds();
  const auto row = std::ranges::find(kinds, address.kind, &BusKind::name);
  return row->open(address.where);
}

}  // namespace

Buses::Buses(cycle::Simulation& simulation, const std::vector<BusAddress>& addresses,
             std::function<void()> wake)
    : simulation_(simulation),
      wake_(std::move(wake)),
      era_(simulation.era()),
      request_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (request_fd_ < 0) throw std::runtime_error("eventfd: no descriptor left");
  if (addresses.size() > kMaxBusLinks)
    throw std::runtime_error("more than " + std::to_string(kMaxBusLinks) + " buses");
  std::vector<BusThread::Wiring> wirings;
  const auto is_named = [](const BusAddress& address) { return !address.part.empty(); };
  for (const auto& address : addresses) {
    const auto is_same_kind = [&](const BusAddress& other) {
      return is_named(other) && other.kind == address.kind;
    };
    if (!is_named(address) && std::ranges::any_of(addresses, is_same_kind)) continue;  // there is one already
    const auto part =
        address.part.empty() ? part_with_modules(simulation) : part_index(simulation, address.part);
    const auto& name = simulation.parts()[part].part->description().name;
    if (!simulation.parts()[part].part->modules())
      throw std::runtime_error("the part '" + name + "' has no modules that a bus could reach");
    auto link = open(address);
    names_[name].push_back(link->name());
    addresses_.push_back({name, link->address()});
    parts_.push_back(part);
    lines_.push_back({LineTiming(address.timing), {}, {}});
    got_.emplace_back(0);
    wirings.push_back({std::move(link), part});
  }
  thread_ = std::make_unique<BusThread>(std::move(wirings), [this] { ring(); });
}

Buses::~Buses() {
  thread_.reset();
  ::close(request_fd_);
}

std::vector<protocol::Exchange> Buses::exchanges() const {
  std::map<std::string, std::uint64_t> by_part;
  for (std::size_t i = 0; i < got_.size(); ++i)
    by_part[addresses_[i].part] += got_[i].load(std::memory_order_relaxed);
  std::vector<protocol::Exchange> exchanges;
  for (const auto& [part, count] : by_part) exchanges.push_back({part, count});
  return exchanges;
}

void Buses::ring() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(request_fd_, &one, sizeof one);
  wake_();
}

void Buses::handle(const BusItem& item) {
  const auto said = simulation_.handle_telegram(parts_[item.link], item.telegram, item.framing);
  if (!said) return;
  const auto passage = simulation_.parts()[parts_[item.link]].part->modules()->passage();
  if (passage.lost) return;
  BusItem reply = item;
  reply.telegram = *said;
  reply.corrupted = passage.corrupted;
  answer(reply, passage.late_ns);
  if (passage.doubled) answer(reply, passage.late_ns);
}

void Buses::answer(const BusItem& item, std::int64_t late_ns) {
  const auto gate = gates_.find(parts_[item.link]);
  const bool waits = gate != gates_.end() && simulation_.tick_count() < gate->second.granted_tick();
  waits ? gate->second.hold({item, late_ns}) : send(item, late_ns);
}

void Buses::send(const BusItem& item, std::int64_t late_ns) {
  auto& [timing, requests, answers] = lines_[item.link];
  if (timing.ideal() && late_ns == 0 && answers.empty()) {
    thread_->answer(item);
    answered_ = true;
    return;
  }
  if (answers.size() == BusThread::kQueue) return;
  answers.push_back({simulation_.sim_time_ns() + timing.delay_ns() + late_ns, {}, item});
}

// Bounded, so that a client that asks faster than it is answered does not hold up the tick.
bool Buses::serve() {
  follow_era();  // requests that come now belong to the new era
  std::size_t count = 0;
  for (BusItem item; count < BusThread::kQueue && thread_->next_request(item); ++count) {
    got_[item.link].fetch_add(1, std::memory_order_relaxed);
    const auto gate = gates_.find(parts_[item.link]);
    gate != gates_.end() ? gate->second.ask(item) : accept(item);
  }
  if (count == BusThread::kQueue) ring();
  if (!gates_.empty()) serve_gates();
  send();
  return count > 0;
}

void Buses::accept(const BusItem& item) {
  auto& [timing, requests, answers] = lines_[item.link];
  if (timing.ideal())
    handle(item);
  else if (requests.size() < BusThread::kQueue)
    requests.push_back({simulation_.sim_time_ns(), {}, item});
}

void Buses::serve_gates() {
  const auto tick = simulation_.tick_count();
  for (auto& [part, gate] : gates_) {
    if (simulation_.frozen()) gate.restart(tick);
    for (const auto& held : gate.released(tick)) send(held.item, held.late_ns);
    while (!line_is_busy(part)) {
      const auto request = gate.next(tick);
      if (!request) break;
      accept(*request);
    }
  }
}

bool Buses::line_is_busy(std::uint32_t part) const {
  for (std::size_t link = 0; link < parts_.size(); ++link)
    if (parts_[link] == part && lines_[link].busy()) return true;
  return false;
}

void Buses::open_gate(std::uint32_t part, CycleRule rule) {
  gates_.emplace(part, CycleGate(std::move(rule), simulation_.tick_count()));
}

void Buses::close_gate(std::uint32_t part) {
  auto closed = gates_.extract(part);
  if (closed.empty()) return;
  auto& gate = closed.mapped();
  gate.restart(simulation_.tick_count());
  for (const auto& held : gate.released(simulation_.tick_count())) send(held.item, held.late_ns);
  for (const auto& request : gate.requests()) accept(request);
  send();
}

// While telegrams are on a line that takes time, the world has to run on, tick by tick.
std::int64_t Buses::granted_tick(std::uint32_t part) const {
  const auto gate = gates_.find(part);
  const auto tick = simulation_.tick_count();
  const auto granted = gate == gates_.end() ? tick : gate->second.granted_tick();
  return line_is_busy(part) ? std::max(granted, tick + 1) : granted;
}

bool Buses::settle(const std::vector<protocol::Stream>& streams) {
  settles_ = true;
  if (!thread_->settle(streams)) spdlog::warn("a client's bytes have not come over its bus");
  return serve();
}

void Buses::send() {
  if (std::exchange(answered_, false)) settles_ ? thread_->send_now() : thread_->flush();
}

void Buses::serve_until(Clock::time_point due) {
  for (;;) {
    serve();
    const auto left = due - Clock::now();
    if (left <= Clock::duration::zero()) return;
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(left).count();
    const timespec wait{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
    pollfd request{request_fd_, POLLIN, 0};
    if (::ppoll(&request, 1, &wait, nullptr) <= 0) continue;
    std::uint64_t count = 0;
    [[maybe_unused]] const auto got = ::read(request_fd_, &count, sizeof count);
  }
}

void Buses::after_tick() {
  move_lines();
  if (!gates_.empty()) serve_gates();
  send_spontaneous();
  send();
}

void Buses::follow_era() {
  if (era_ == simulation_.era()) return;
  era_ = simulation_.era();
  for (auto& line : lines_) {
    line.timing.restart();
    line.requests.clear();
    line.answers.clear();
  }
  for (auto& [part, gate] : gates_) gate.begin_era(simulation_.tick_count());
}

void Buses::move_lines() {
  follow_era();
  for (auto& line : lines_) {
    while (const auto first = next_through(line)) {
      if (first->way == LineTiming::Way::kToModules) {
        handle(first->item);
        continue;
      }
      thread_->answer(first->item);
      answered_ = true;
    }
  }
}

// The first telegram of a direction takes the line once it is ready, and not before; a late one leaves the
// line to others. If both directions are ready, the one that was ready first goes first.
std::optional<Buses::Through> Buses::next_through(LinkQueues& line) const {
  using Way = LineTiming::Way;
  const auto now = simulation_.sim_time_ns();
  const auto queue_of = [&line](Way way) -> auto& {
    return way == Way::kToModules ? line.requests : line.answers;
  };
  const auto ready_ns = [&](Way way) {
    return queue_of(way).empty() ? std::numeric_limits<std::int64_t>::max() : queue_of(way).front().ready_ns;
  };
  std::array ways{Way::kToModules, Way::kFromModules};
  if (ready_ns(ways[1]) < ready_ns(ways[0])) std::swap(ways[0], ways[1]);
  for (const auto way : ways) {
    if (ready_ns(way) > now) continue;
    auto& [ready, through, item] = queue_of(way).front();
    if (!through) through = line.timing.pass(item.telegram, item.framing, way, ready);
    if (*through > now) continue;
    const Through first{way, item};
    queue_of(way).pop_front();
    return first;
  }
  return std::nullopt;
}

void Buses::send_spontaneous() {
  for (std::uint32_t link = 0; link < parts_.size(); ++link) {
    // Once for each part: the bus thread spreads it over all its links.
    if (std::ranges::find(parts_, parts_[link]) != parts_.begin() + link) continue;
    auto& modules = *simulation_.parts()[parts_[link]].part->modules();
    const auto telegrams = modules.spontaneous();
    for (std::size_t i = 0; i < telegrams.size(); ++i) {
      const auto& passage = modules.spontaneous_passage(i);
      if (passage.lost) continue;
      for (int times = passage.doubled ? 2 : 1; times > 0; --times)
        thread_->answer({link, 0, powercube::BusFraming::kCan, telegrams[i], passage.corrupted});
      answered_ = true;
    }
  }
}

}  // namespace visum::bus
