// What a world did last, always kept in memory, for the case that it freezes: then the ticks before it, their
// inputs and the whole state that they began with are written to a file, as a recording that replays. Two
// halves take turns, so that it holds between one and two thousand ticks in bounded memory; once warm, a tick
// allocates nothing. Lives on the tick's thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "protocol/recording/records.h"
#include "server/cycle/simulation.h"
#include "server/recording/beginning.h"

namespace visum::recording {

class FlightRecorder : public cycle::Observer {
 public:
  static constexpr std::size_t kTicks = 1000;           // of a half
  static constexpr std::size_t kHashEvery = 50;         // ticks: to hash each of them costs a tenth of a tick
  static constexpr std::size_t kInputBytes = 1u << 20;  // of a half: more of them end it sooner
  static constexpr int kMostFiles = 10;  // of one run: who freezes it over and over fills no disk

  // `folder`: where the file is made, which has not to be there yet.
  FlightRecorder(cycle::Simulation& simulation, Origin origin, std::filesystem::path folder);
  ~FlightRecorder() override;

  void took(const TimedInput& input) override;
  void ticked() override;

  // The file of the freeze that the world is in; empty: it is in none, or there was no writing it.
  const std::string& dump() const { return dump_; }

 private:
  struct KeptInput {
    std::size_t ticks;  // of the half that were before it
    std::int64_t tick;  // of the world that took it
    std::size_t from, size;
  };
  struct Half {
    State begin;
    std::vector<Tick> ticks;    // without their fault
    std::vector<double> ports;  // of each tick: by part its inputs, then its outputs
    std::vector<KeptInput> inputs;
    std::vector<std::byte> input_bytes;
    bool in_use = false;
  };

  void begin_half();
  void forget();
  void dump_now();
  std::filesystem::path make_file() const;
  void write(const std::filesystem::path& file) const;
  void write_half(const Half& half, McapWriter& writer, const Channels& channels,
                  std::uint64_t& time_ns) const;

  cycle::Simulation& simulation_;
  const Origin origin_;
  const std::filesystem::path folder_;
  Half now_, before_;
  std::size_t ports_per_tick_ = 0;
  std::string dump_;
  int files_ = 0;
};

}  // namespace visum::recording
