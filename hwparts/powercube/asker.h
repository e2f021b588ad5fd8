// The asking side of the protocol: sends requests to modules and receives their answers, over a connection
// that may lose both. On RS-232 one request is out at a time, on CAN one for each module. A request that is
// not answered in time is repeated, then given up. An answer belongs to a request if module, command and (if
// there is one) parameter are the same. All other frames are dropped, as m5api does it. A program owns it
// beside its BusConnection and uses it from one thread.
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

  // True while a request to `module` may be sent.
  bool may_ask(int module) const;
  // Sends a request. `patience` takes the place of the usual one.
  void ask(int module, const Message& request, const std::optional<Patience>& patience = {});
  // Broadcasts a message. Modules do not answer it.
  void tell_all(const Message& message);

  struct Outcome {
    int module = 0;
    Message request;
    std::optional<Message> answer;  // nothing: given up
  };
  // The next request that was answered or given up, one per call. Repeats requests that are overdue. Does not
  // wait.
  std::optional<Outcome> next();
  // Sends one request and waits for its answer; nothing: given up. No other request may be out.
  std::optional<Message> ask_and_wait(int module, const Message& request,
                                      const std::optional<Patience>& patience = {});
  // Gives up all requests that are out, without an outcome.
  void forget();
  // When the next request will be overdue; int64's maximum where none is out.
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
  int count_ = 0;                        // requests that wait for an answer
};

}  // namespace visum::powercube
