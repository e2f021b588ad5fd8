// The time line: which entries are due at a step. Each is due once, at the first step at or after its time,
// or at the first step at which its condition holds; those of one step in the order of the file.
#pragma once

#include <optional>
#include <vector>

#include "clients/visum/run/quantity.h"

namespace visum::run {

class Timeline {
 public:
  // `entries` must outlive the time line. Throws ConfigError where an entry names what is not there, or a
  // value that its port does not take.
  Timeline(const std::vector<TimelineEntry>& entries, const Catalogue& catalogue);

  void tie_again(const Catalogue& catalogue);  // after bodies came or went: what is still to come
  std::vector<const TimelineEntry*> due(const Observation& now);
  // Entries that never came due.
  std::vector<const TimelineEntry*> missed() const;

 private:
  struct Item {
    const TimelineEntry* entry;
    std::optional<Quantity> quantity;
    bool done = false;
  };
  std::vector<Item> items_;
};

}  // namespace visum::run
