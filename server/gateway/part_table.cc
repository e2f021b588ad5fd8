#include "server/gateway/part_table.h"

#include <algorithm>

#include "server/gateway/idle_part.h"
#include "server/scene/spawn.h"

namespace visum::gateway {
namespace {

class NoPart final : public IdlePart {
 public:
  const protocol::PartDescription& description() const override { return description_; }

 private:
  const protocol::PartDescription description_{};
};

}  // namespace

std::vector<std::uint32_t> changed_parts(const PartTable& before, const PartTable& now) {
  std::vector<std::uint32_t> changed;
  for (std::uint32_t part = 0; part < now.slots.size(); ++part)
    if (part >= before.slots.size() || before.slots[part].part != now.slots[part].part)
      changed.push_back(part);
  return changed;
}

std::shared_ptr<const hwparts::Part> no_part() {
  static const auto none = std::make_shared<const NoPart>();
  return none;
}

PartNumbers::PartNumbers(const cycle::Simulation& simulation)
    : simulation_(simulation),
      most_(std::max(simulation.own_parts(), cycle::SceneChange::kMostParts) + scene::kMaxSpawnedParts) {
  follow();
}

bool PartNumbers::follow() {
  const auto parts = simulation_.parts();
  const auto same = [&](std::size_t i) { return table_->slots[table_->slot_of[i]].part == parts[i].part; };
  bool unchanged =
      table_ && table_->scene_number == simulation_.scene_number() && table_->slot_of.size() == parts.size();
  for (std::size_t i = 0; unchanged && i < parts.size(); ++i) unchanged = same(i);
  if (unchanged) return false;
  auto next = table_ ? std::make_shared<PartTable>(*table_) : std::make_shared<PartTable>();
  for (auto& slot : next->slots)
    if (slot.part != no_part() && std::ranges::find(parts, slot.part, &cycle::BoundPart::part) == parts.end())
      slot = {no_part(), {}, slot.generation + 1};
  next->scene_number = simulation_.scene_number();
  next->scene = simulation_.scene().name;
  next->lockstep_timeout = std::chrono::nanoseconds(simulation_.scene().lockstep_timeout_ns);
  next->slot_of.clear();
  index_.assign(most(), std::nullopt);
  for (const auto& bound : parts) {
    auto slot = std::ranges::find(next->slots, bound.part, &PartTable::Slot::part);
    if (slot == next->slots.end()) {
      slot = std::ranges::find(next->slots, no_part(), &PartTable::Slot::part);
      if (slot == next->slots.end()) slot = next->slots.insert(slot, PartTable::Slot{no_part(), {}, 0});
      *slot = {bound.part, bound.agent, slot->generation};
    }
    const auto number = static_cast<std::uint32_t>(slot - next->slots.begin());
    index_[number] = static_cast<std::uint32_t>(next->slot_of.size());
    next->slot_of.push_back(number);
  }
  table_ = std::move(next);
  return true;
}

std::optional<std::uint32_t> PartNumbers::find(std::uint32_t slot, std::uint32_t generation) const {
  if (slot >= table_->slots.size() || table_->slots[slot].generation != generation) return {};
  return index_[slot];
}

}  // namespace visum::gateway
