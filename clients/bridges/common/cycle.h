// A bridge in lockstep (grade L1): the world stands until the messages that the user has named have arrived,
// or until somebody asks for a step. It then runs for one period. All messages of a cycle act together, at
// its end and in an order that does not depend on when they came. On the bridge's one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "clients/bridges/common/plant.h"

namespace visum::bridge {

class Cycle {
 public:
  static constexpr std::size_t kMostMessages = 4096;  // in one cycle
  static constexpr std::int64_t kMostSteps = 1'000'000;

  struct Message {
    std::string client;  // who sent it
    std::string name;    // the port that it writes
    std::function<void()> act;
  };

  // Joins the lockstep. Throws visum::Error if the server's clock is another, and cli::ExitError(kUsage) if a
  // gate names no port of a part. A gate is a controller input as "PART/PORT".
  Cycle(Plant& plant, std::int64_t period_ns, const std::vector<std::string>& gates);

  // Keeps a message for the end of the cycle. Returns why it cannot; empty: it is kept.
  std::string latch(Message message);
  // Asks for more cycles, whether their messages arrive or not. Returns why not; empty: they will come.
  std::string ask_for_steps(std::int64_t count);

  // Ends the cycle if it is complete, and finds out whether the world has run as far as it was asked to.
  // Never waits for longer than a millisecond. Returns true if the values of the parts are new.
  bool work();
  bool is_running() const { return running_; }  // the world has not run the last period to its end yet

 private:
  bool is_complete() const;
  void act();

  Plant& plant_;
  const std::int64_t period_ns_;
  std::map<std::string, bool> gates_;  // by name: has it arrived?
  std::vector<Message> messages_;      // in the order of arrival
  std::int64_t steps_ = 0;
  bool running_ = false;
};

}  // namespace visum::bridge
