// Writes of which a tick has enough: what a wire held up and delivers at once, a client that is too quick, or
// one that writes to a world that stands. Of each part, the ports that a tick to come is to be told of (in
// realtime the one after it, else the next); their values are those latched last, so that any number of
// writes costs one more input. Lives on the sessions' thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace visum::gateway {

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

  // The first of the part's ports with those that follow it without a gap: from, to behind the last. They are
  // late no more.
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
  std::vector<std::vector<bool>> ports_;  // by part; empty: none
};

}  // namespace visum::gateway
