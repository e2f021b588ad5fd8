// Simulation: the faults that act.
#include <algorithm>
#include <stdexcept>

#include "server/cycle/simulation.h"

namespace visum::cycle {

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
