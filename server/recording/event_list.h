// Tells in words what happened in a recording: faults, lost controllers, resets, freezes, lines of the log.
// For logs and timelines. What a hand does all the time is left out: writes, pushes, pulls, bodies and joints
// that are put elsewhere. Any one thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/messages.h"
#include "protocol/recording/recording_file.h"

namespace visum::recording {

struct RecordedEvent {
  std::uint64_t position = 0;  // ticks since the file's beginning; of a line of the log about there
  protocol::Event event;       // of the kinds that a live server tells; also "parameter"
};

class EventList {
 public:
  static constexpr std::size_t kMostEvents = 5000;  // of a file; the first ones are kept
  static constexpr std::size_t kMostBytes = 1000;   // of a text; the rest is cut off

  // Call it for each item of the file, in order. `position`: with the item, if it is a tick.
  void take(const RecordingFile::Item& item, std::uint64_t position);

  const std::vector<RecordedEvent>& events() const { return events_; }
  std::uint64_t left_out() const { return left_out_; }

 private:
  void add(std::string kind, std::string_view text, std::string_view part, protocol::EventLevel level);
  void take(const TimedInput& input);
  void take(const Tick& tick);

  std::vector<RecordedEvent> events_;
  std::uint64_t left_out_ = 0;
  std::uint64_t position_ = 0;
  std::uint64_t era_ = 1;
  std::int64_t tick_ = 0, sim_time_ns_ = 0;  // of the last tick
};

}  // namespace visum::recording
