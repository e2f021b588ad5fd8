// What a user sees while a scenario runs: the lines of daemon and controllers and, if asked for and on a
// terminal, one line that is updated.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace visum::run {

class Progress {
 public:
  // Lines go to stderr; the updated line to `stream`.
  Progress(bool wanted, std::FILE* stream);

  void line(const std::string& who, const std::string& text);
  void step(double sim_s);
  void finish();  // clears the updated line

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
