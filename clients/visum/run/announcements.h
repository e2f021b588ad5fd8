// Lines of controllers and results of checks, for those who follow the server's events. Main thread; the
// runner owns it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "clients/visum/run/check.h"
#include "clients/visum/run/session.h"

namespace visum::run {

class Announcements {
 public:
  static constexpr std::size_t kMost = 1000;  // that wait; more are left out, and the last one says so

  void add_line(const std::string& who, const std::string& line);
  void add_check(const CheckResult& check);
  // Sends what waits, without an answer, unless steps are under way: behind them it would wait for the world.
  // Throws ConnectionError where the daemon is gone.
  void flush(Session& session);

 private:
  void add(const std::string& text, const std::string& kind, protocol::EventLevel level);

  std::vector<protocol::Announce> waiting_;
  std::size_t left_out_ = 0;
};

}  // namespace visum::run
