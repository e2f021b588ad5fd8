// The asking side of the protocol: requests to modules, and their answers, over a line that may lose both. On
// RS-232 one request is out at a time, on CAN one for each module. What is not answered in time is repeated,
// then given up. An answer belongs to a request if module, command and, where there is one, parameter are the
// same; all else that comes in is dropped, as m5api does it. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hwparts/powercube/bus_connection.h"

namespace visum::powercube {

struct Patience {
  // m5api waits 30 ms for each module that it knows; a module answers within 2.
  std::int64_t answer_ns = 50'000'000;
  int tries = 3;
};

class Asker {
 public:
  explicit Asker(BusConnection& line, const Patience& patience = {}) : line_(line), patience_(patience) {}

  // True while `module` may be asked something.
  bool may_ask(int module) const;
  // `patience`: instead of the usual.
  void ask(int module, const Message& request, const std::optional<Patience>& patience = {});
  // To everybody; nobody answers.
  void tell_all(const Message& message);

  struct Outcome {
    int module = 0;
    Message request;
    std::optional<Message> answer;  // none: given up
  };
  // What came in or was given up since, one by one; repeats what is overdue. Does not wait.
  std::optional<Outcome> next();
  // The answer to one request, while no other is out; waits.
  std::optional<Message> ask_and_wait(int module, const Message& request,
                                      const std::optional<Patience>& patience = {});
  // Gives up all that is out, without an outcome.
  void forget();
  // When something will be overdue; int64's maximum: nothing is out.
  std::int64_t next_due_ns() const;

  BusConnection& line() { return line_; }
  const Patience& patience() const { return patience_; }

 private:
  struct Out {
    bool waits = false;
    Message request;
    std::int64_t due_ns = 0;
    std::int64_t answer_ns = 0;
    int tries_left = 0;
  };
  void send(int module);

  BusConnection& line_;
  Patience patience_;
  std::array<Out, kMaxModule + 1> out_;  // by module id
  int count_ = 0;                        // that wait
};

}  // namespace visum::powercube
