// Keeps the last ticks of a world in memory, in case the world freezes. Then it writes a recording that can
// be replayed: the whole state at some tick, the ticks after it with all ports, and their inputs.
//
// Two halves of a thousand ticks take turns, so that it holds between one and two thousand ticks in bounded
// memory. Once warm, a tick allocates nothing. Lives on the tick's thread, where the file is written, too:
// the world stands then. A file that cannot be written is logged; the world does not care.
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
  static constexpr std::size_t kInputBytes = 1u << 20;  // of a half: more of them end it sooner
  static constexpr int kMostFiles = 10;  // of one run: a world that freezes over and over fills no disk

  // Observes the simulation, which must outlive this. `folder`: for the files; made when it is needed.
  FlightRecorder(cycle::Simulation& simulation, Origin origin, std::filesystem::path folder);
  ~FlightRecorder() override;

  void took(const TimedInput& input) override;
  void ticked() override;

  // The file of the present freeze; empty: the world runs, or the file could not be written.
  const std::string& dump() const { return dump_; }

 private:
  struct KeptInput {
    std::size_t ticks;       // how many ticks of the half came before it
    std::int64_t tick;       // of the world when it took the input
    std::size_t from, size;  // in input_bytes
  };
  struct Half {
    State begin;                // the whole state before its first tick
    std::vector<Tick> ticks;    // without their fault: only the last tick can have one
    std::vector<double> ports;  // for each tick and part: inputs, then outputs
    std::vector<KeptInput> inputs;
    std::vector<std::byte> input_bytes;  // encoded inputs, one behind the other
    bool in_use = false;
  };

  // The present half becomes the one before; the older one is overwritten.
  void begin_half();
  void forget();
  void begin_scene(const LoadedScene& scene);
  // True if the parts are others than those whose ports the halves hold; from now on they are these.
  bool parts_changed();
  // Writes both halves to a new file, and logs where it is or why it is not.
  void dump_now();
  // Makes an empty file of a name that no other file has.
  std::filesystem::path make_file() const;
  void write(const std::filesystem::path& file) const;
  // Appends a half; `time_ns` counts the ticks of the file.
  void write_half(const Half& half, McapWriter& writer, const Channels& channels,
                  std::uint64_t& time_ns) const;

  cycle::Simulation& simulation_;
  Origin origin_;
  const std::filesystem::path folder_;
  Half now_, before_;
  std::size_t ports_per_tick_ = 0;
  std::vector<const hwparts::Part*> parts_;  // whose ports the halves hold
  std::uint64_t revision_ = 0;               // of the world at the last input
  std::string dump_;
  int files_ = 0;
};

}  // namespace visum::recording
