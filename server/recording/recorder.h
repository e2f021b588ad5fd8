// Records a world in a file that holds everything that a replay needs: the scene's files, each input that the
// world took between ticks, after each tick every port, and after some the hash of the state (records.h).
// Once per simulated second it adds the whole state, so that a player can seek.
//
// Lives on the tick's thread and never makes a realtime tick wait: a thread of its own writes the file
// (recording_writer.h). Where the disk fails, the recording ends, the log says so, and the world goes on.
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
  // Observes the simulation from now on. That must be before its first tick and input, unless
  // `origin.has_past`. Throws std::runtime_error where the file cannot be written.
  Recorder(cycle::Simulation& simulation, const Origin& origin, const std::filesystem::path& file);
  ~Recorder() override;  // completes the file

  // For a recording of a world that runs already, beside its other observer: makes the file's beginning, on
  // any thread. Then begin() on the tick's thread, which notes the state, and write_first() on any thread
  // soon: what the world does meanwhile waits in the queue. At last end() on the tick's thread, and the
  // destructor on any thread.
  static std::unique_ptr<Recorder> prepare(cycle::Simulation& simulation, const Origin& origin,
                                           const std::filesystem::path& file);
  void begin();
  void write_first();

  // Tick's thread, between ticks. Observes no more. Adds the whole state, where the last tick has no hash, so
  // that a replay knows that all came out the same and not only the ports.
  void end();
  // Completes the file. A second observer must have called end() before; the first one observes no more in
  // any case. Returns whether the file holds all that happened; the log has said why not.
  bool close();

  void took(const TimedInput& input) override;
  void ticked() override;
  void log(std::string_view level, std::string_view text);  // any thread

 private:
  enum class Start { kNow, kLater };
  Recorder(cycle::Simulation& simulation, const Origin& origin, const std::filesystem::path& file,
           Start start);
  void put(std::uint16_t channel, std::int64_t publish_time_ns);  // hands bytes_ to the writer
  void take_state();                                              // encodes the whole state into bytes_
  void put_state();
  void stop_observing();
  // Finds the channel of each part, once the parts are others, and describes those that came.
  void look_at_parts();

  cycle::Simulation& simulation_;
  const bool is_second_;  // begun by prepare()
  const std::unique_ptr<RecordingWriter> writer_;
  Channels channels_;
  std::uint64_t time_ns_ = 0;                    // the length of all ticks so far, over all eras
  std::uint64_t next_state_ns_ = 1'000'000'000;  // of time_ns_: when the next whole state is due
  std::uint64_t ticks_ = 0;
  bool hash_is_written_ = true;  // of the state as it is now; also before the first tick and input
  State state_;
  State first_;  // from begin() to write_first()
  // The parts of the beginning, by their channels, kept so that none is taken for another; and the channel of
  // each part of the world.
  std::vector<std::shared_ptr<const hwparts::Part>> known_;
  std::vector<std::uint16_t> channel_of_;
  std::vector<const hwparts::Part*> seen_;  // parts of the world at the last look
  std::uint64_t revision_ = 0;
  std::vector<std::byte> bytes_;
};

}  // namespace visum::recording
