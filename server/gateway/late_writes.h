// Writes that are more than one tick takes: from a network that held them up and delivers them at once, from
// a client that is too quick, or from one that writes while the world stands still.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace visum::gateway {

// Keeps for each part only the ports that a later tick has to be told of: in realtime the tick after the
// next, else the next. Their values are those latched last. So any number of late writes costs one more input
// for each run of neighbouring ports. Lives on the sessions' thread; Parts owns it.
class LateWrites {
 public:
  // Ports `first`, `first + 1`, ... of a part.
  void add(std::uint32_t part, std::uint32_t first, std::size_t count) {
    if (part >= ports_.size()) ports_.resize(part + 1);
    auto& ports = ports_[part];
    if (ports.size() < first + count) ports.resize(first + count);
    std::fill_n(ports.begin() + first, count, true);
  }
  void drop(std::uint32_t part) {
    if (part < ports_.size()) ports_[part].clear();
  }
  bool empty() const { return std::ranges::all_of(ports_, &std::vector<bool>::empty); }
  bool has(std::uint32_t part) const { return part < ports_.size() && !ports_[part].empty(); }

  // Takes out the first late port and those that follow it without a gap. Returns the first, and the one
  // after the last.
  std::pair<std::uint32_t, std::uint32_t> take_run(std::uint32_t part) {
    auto& ports = ports_[part];
    const auto from = std::ranges::find(ports, true);
    const auto to = std::find(from, ports.end(), false);
    const std::pair run{static_cast<std::uint32_t>(from - ports.begin()),
                        static_cast<std::uint32_t>(to - ports.begin())};
    std::fill(from, to, false);
    if (std::find(to, ports.end(), true) == ports.end()) ports.clear();
    return run;
  }

 private:
  std::vector<std::vector<bool>> ports_;  // by part, by port; empty: no port is late
};

}  // namespace visum::gateway
