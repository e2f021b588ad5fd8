// The output while a scenario runs: the lines of the daemon and of the controllers. If wanted, also time,
// pace and the last line of a controller: on a terminal as one line that is updated, else as a line every
// five seconds. Lives on the main thread; the verb `run` owns it.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace visum::run {

class Progress {
 public:
  // Lines go to stderr, the updated line to `stream`.
  Progress(bool wanted, std::FILE* stream);

  void line(const std::string& who, const std::string& text);
  void step(double sim_s);  // after each step of the world
  void finish();            // clears the updated line

 private:
  using Clock = std::chrono::steady_clock;
  void draw(double sim_s, Clock::time_point now);

  std::FILE* stream_;
  bool wanted_, live_;
  std::string phase_;  // the last line of a controller
  bool shown_ = false;
  bool began_ = false;
  Clock::time_point begin_, due_;
};

}  // namespace visum::run
