// The time line tells which entries are due at a step. Each is due once: at the first step at or after its
// time, or at the first step at which its condition holds. Entries of one step come in the order of the file.
// The runner owns it.
#pragma once

#include <optional>
#include <vector>

#include "clients/visum/run/quantity.h"

namespace visum::run {

class Timeline {
 public:
  // `entries` must outlive the time line. Throws ConfigError if an entry names something that is not there,
  // or a value that its port does not take.
  Timeline(const std::vector<TimelineEntry>& entries, const Catalogue& catalogue);

  void tie_again(const Catalogue&
                     catalogue);  // finds the bodies of entries still to come anew, after bodies came or went
  std::vector<const TimelineEntry*> due(const Observation& now);
  // True if an entry that is still to come depends on the world. It may come due at any step.
  bool has_conditions() const;
  // The earliest time of the entries that are still to come; infinity: there are none.
  double next_s() const;
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
