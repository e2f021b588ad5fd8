#include "hwparts/fault_set.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace visum::hwparts {

bool FaultSet::inject(const ActiveFault& fault) {
  const auto same = [&](const ActiveFault& one) {
    return one.part == fault.part && one.fault.same_place(fault.fault);
  };
  if (const auto found = std::ranges::find_if(active_, same); found != active_.end()) {
    *found = fault;
    return true;
  }
  if (active_.size() == kMost) return false;
  const auto behind = std::ranges::upper_bound(active_, fault.part, {}, &ActiveFault::part);
  active_.insert(behind, fault);
  return true;
}

std::size_t FaultSet::clear(std::uint32_t part, std::optional<FaultKind> kind,
                            std::optional<std::size_t> drive) {
  return std::erase_if(active_, [&](const ActiveFault& one) {
    const bool there =
        !drive || (fault_info(one.fault.kind).target == FaultTarget::kDrive && one.fault.drive() == *drive);
    return one.part == part && (!kind || one.fault.kind == *kind) && there;
  });
}

bool FaultSet::expire(std::int64_t tick) {
  return std::erase_if(active_, [tick](const ActiveFault& one) {
           return one.until_tick != 0 && one.until_tick <= tick;
         }) != 0;
}

std::span<const ActiveFault> FaultSet::of(std::uint32_t part) const {
  const auto first = std::ranges::lower_bound(active_, part, {}, &ActiveFault::part);
  return {first, std::ranges::upper_bound(first, active_.end(), part, {}, &ActiveFault::part)};
}

const ActiveFault* FaultSet::find(std::uint32_t part, FaultKind kind) const {
  for (const auto& one : of(part))
    if (one.fault.kind == kind) return &one;
  return nullptr;
}

void FaultSet::move_ends(std::int64_t ticks) {
  for (auto& active : active_)
    if (active.until_tick != 0) active.until_tick -= ticks;
}

void FaultSet::renumber_parts(std::span<const std::uint32_t> now) {
  std::erase_if(active_, [&](const ActiveFault& active) { return now[active.part] == kGone; });
  for (auto& active : active_) active.part = now[active.part];
}

void FaultSet::save(StateWriter& to) const {
  to.put(static_cast<std::uint64_t>(active_.size()));
  for (const auto& one : active_) {
    to.put(one.part), to.put(one.fault.kind), to.put(one.until_tick);
    to.put(std::span<const double>(one.fault.numbers));
  }
}

void FaultSet::load(StateReader& from, std::size_t parts) {
  std::uint64_t count = 0;
  from.get(count);
  if (count > kMost) throw std::out_of_range("more faults than can act at once");
  active_.clear();
  for (; count > 0; --count) {
    ActiveFault one;
    from.get(one.part), from.get(one.fault.kind), from.get(one.until_tick);
    from.get(std::span<double>(one.fault.numbers));
    if (!is_fault_kind(one.fault.kind)) throw std::out_of_range("a fault of no kind");
    if (one.part >= parts) throw std::out_of_range("a fault of no part");
    const FaultInfo& kind = fault_info(one.fault.kind);
    std::string why;
    const auto made =
        make_fault(kind, std::span<const double>(one.fault.numbers).first(number_count(kind)), why);
    if (!made) throw std::out_of_range(why);
    inject({one.part, *made, one.until_tick});
  }
}

}  // namespace visum::hwparts
