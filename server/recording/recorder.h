// Writes down what happens in a world: everything that it takes between ticks, and after each tick every port
// and the hash of its state, in a file that holds all that is needed to go through it again. Lives on the
// tick's thread and never holds it up; the file is written by a thread of its own (recording_writer.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "protocol/recording/records.h"
#include "server/cycle/simulation.h"
#include "server/recording/beginning.h"

namespace visum::recording {

class RecordingWriter;

class Recorder : public cycle::Observer {
 public:
  // From now on, which has to be before the first tick and the first input, or `origin` says that the world
  // has a past. Throws std::runtime_error where the file cannot be written.
  Recorder(cycle::Simulation& simulation, const Origin& origin, const std::filesystem::path& file);
  ~Recorder() override;  // finishes the file

  void took(const TimedInput& input) override;
  void ticked() override;
  void log(std::string_view level, std::string_view text);  // any thread

 private:
  void put(std::uint16_t channel, std::int64_t publish_time_ns);  // what stands in bytes_
  void take_state();                                              // into bytes_
  void put_state();

  cycle::Simulation& simulation_;
  const std::unique_ptr<RecordingWriter> writer_;
  Channels channels_;
  std::uint64_t time_ns_ = 0;                    // of all ticks so far, in all eras
  std::uint64_t next_state_ns_ = 1'000'000'000;  // the whole state is due
  State state_;
  std::vector<std::byte> bytes_;
};

}  // namespace visum::recording
