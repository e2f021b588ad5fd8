// A histogram of how late ticks begin. Its size is fixed: eight bins per octave from 1 ns to 2^40 ns, so that
// a quantile is right to 9 %. One thread adds, any thread reads: the counts are relaxed atomics.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>

namespace visum::cycle {

class LatenessHistogram {
 public:
  void add(std::int64_t ns) {
    if (ns < 0) ns = 0;
    bins_[bin(ns)].fetch_add(1, std::memory_order_relaxed);
    if (ns > max_.load(std::memory_order_relaxed)) max_.store(ns, std::memory_order_relaxed);
  }
  // The lateness in ns that a share `q` (0..1) of all ticks does not exceed; 0 before the first tick.
  std::int64_t quantile(double q) const {
    std::uint64_t total = 0;
    for (const auto& count : bins_) total += count.load(std::memory_order_relaxed);
    const double wanted = q * static_cast<double>(total);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      seen += bins_[i].load(std::memory_order_relaxed);
      if (seen > 0 && static_cast<double>(seen) >= wanted)
        return upper_edge(i) < max() ? upper_edge(i) : max();
    }
    return max();
  }
  std::int64_t max() const { return max_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kBins = 40 * 8;
  static std::size_t bin(std::int64_t ns) {
    const auto value = static_cast<std::uint64_t>(ns) + 8;  // below 8 ns each ns has a bin of its own
    const int octave = std::bit_width(value) - 4;
    const auto index = static_cast<std::size_t>(octave) * 8 + static_cast<std::size_t>((value >> octave) & 7);
    return index < kBins ? index : kBins - 1;
  }
  static std::int64_t upper_edge(std::size_t index) {
    const auto octave = index / 8;
    return static_cast<std::int64_t>((static_cast<std::uint64_t>(index % 8 + 9) << octave) - 8 - 1);
  }
  std::array<std::atomic<std::uint64_t>, kBins> bins_{};
  std::atomic<std::int64_t> max_{0};
};

}  // namespace visum::cycle
