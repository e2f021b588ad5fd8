// Simulation: the faults that act, and how a BoundPart's network behaves while they do.
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "server/cycle/simulation.h"

namespace visum::cycle {

void BoundPart::hear(std::int64_t tick, std::size_t first, std::span<const double> values) {
  if (silent) return;
  if (!network.ideal()) return network.send(tick, first, values);
  take(first, values);
}

void BoundPart::take(std::size_t first, std::span<const double> values) {
  std::ranges::copy(values, controller_inputs.begin() + static_cast<std::ptrdiff_t>(first));
  part->latch(controller_inputs);
}

void BoundPart::deliver(std::int64_t until_tick) {
  if (network.ideal()) return;
  for (auto& delay_line = network.writes(); delay_line.due(until_tick); delay_line.pop())
    take(delay_line.first(), delay_line.front());
}

std::vector<double>& BoundPart::readings(std::vector<double>& lost) {
  auto& shown = network.ideal() ? sensor_outputs : network.readings();
  if (!silent) return shown;
  lost = shown;
  return lost;
}

void BoundPart::set_network(const NetworkModel::Quality& quality, std::uint64_t seed) {
  if (network.quality() == quality) return;
  if (!network.ideal()) {
    deliver(std::numeric_limits<std::int64_t>::max());
    sensor_outputs = network.readings();
  }
  network.begin(quality, seed, sensor_outputs, controller_inputs.size());
}

Outcome Simulation::inject(const hwparts::ActiveFault& fault) {
  if (!faults_.inject(fault)) return {Refusal::kFull, "too many faults act at once"};
  hand_out_faults();
  const auto& kind = hwparts::fault_info(fault.fault.kind);
  const auto numbers = std::span<const double>(fault.fault.numbers).first(hwparts::number_count(kind));
  tell(now(), recording::InjectFault{name_of(fault.part), kind.name, numbers, fault.until_tick});
  return {};
}

void Simulation::clear_faults(std::size_t part, std::optional<hwparts::FaultKind> kind,
                              std::optional<std::size_t> drive) {
  if (faults_.clear(static_cast<std::uint32_t>(part), kind, drive) == 0) return;
  hand_out_faults();
  tell(now(), recording::ClearFault{name_of(part), kind ? hwparts::fault_info(*kind).name : "",
                                    drive ? static_cast<std::uint32_t>(*drive) + 1 : 0});
}

void Simulation::end_faults() {
  if (faults_.expire(state_.tick)) hand_out_faults();
}

void Simulation::load_faults(hwparts::StateReader& from) {
  faults_.load(from, parts_.size());
  for (const auto& active : faults_.all()) {
    const auto& part = *parts_[active.part].part;
    if (!part.has(hwparts::fault_info(active.fault.kind).target))
      throw std::out_of_range("a fault of a part that has none of the kind");
    const auto room = NetworkModel::has_room_for(active.fault, part.description(), scene_->world.tick_ns);
    if (!room.done()) throw std::out_of_range(room.text());
  }
}

void Simulation::hand_out_faults() {
  for (std::uint32_t part = 0; part < parts_.size(); ++part) {
    const auto own = faults_.of(part);
    auto& bound = parts_[part];
    bound.part->set_faults(own);
    bound.silent = faults_.find(part, hwparts::FaultKind::kPartSilent) != nullptr;
    bound.set_network(NetworkModel::quality_of(own, scene_->world.tick_ns), scene_->seed + part);
  }
}

}  // namespace visum::cycle
