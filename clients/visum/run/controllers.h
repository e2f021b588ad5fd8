// The scenario's controllers as processes and as members of the lockstep.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "clients/visum/run/child_process.h"
#include "clients/visum/run/scenario.h"
#include "clients/visum/run/session.h"
#include "clients/visum/run/wait_loop.h"

namespace visum::run {

struct ControllerResult {
  std::string name;
  std::string end;                      // "exited with code 0", "was stopped at the end"
  std::string failure;                  // empty if it ended well
  std::vector<std::string> last_lines;  // of its output
  bool lost = false;                    // the failure is not an exit code: a signal, or it was late
};

class Controllers {
 public:
  using OnLine = std::function<void(const std::string& controller, const std::string& line)>;

  // `specs` must outlive it. `values` fill the placeholders of the commands.
  Controllers(const std::vector<ControllerSpec>& specs, const std::map<std::string, std::string>& values,
              Session& session, WaitLoop& wait_loop, OnLine on_line);
  ~Controllers();  // stops those that still run, all at once

  // Starts all, and returns when those that join the clock have joined it. Throws ConfigError where a program
  // cannot be started, ExitError where one ends before it joined (kFailed) or does not join in time (kLost).
  void start(double patience_s);

  // While we hold the world: waits until every member either lets the world run on or has left, and for those
  // that have left, until they have ended. What it knows then does not depend on who was faster. `status` is
  // the newest there is.
  void settle(protocol::ServerStatus status);
  // Members that the server no longer waits for: who was to be let go on (`on_timeout`) has no clock from now
  // on. Throws ExitError(kLost) of others.
  void note_timeouts();
  bool any_in_real_time() const;  // let go on, and not ended
  // All have ended or are known to have left.
  bool all_done() const;

  // Throws ExitError where one ended badly: kFailed for an exit code, kLost for a signal that the time line
  // did not send.
  void check_ends();
  void signal(const std::string& name, int number);
  void stop_all();
  std::vector<ControllerResult> results() const;

 private:
  struct Controller {
    const ControllerSpec* spec = nullptr;
    std::unique_ptr<ChildProcess> process;
    bool joins = false, joined = false, left = false;
    bool signalled = false;  // by the time line: its end is no failure
    bool stopped = false;    // by us, at the end
    bool let_go = false;     // it was late, and goes on by itself
    std::string lost;        // it was late, and its parts were stopped: why
  };

  void start_one(Controller& controller);
  void await_joined(double patience_s);
  bool is_undecided(const protocol::ServerStatus& status) const;
  void note_who_left(const protocol::ServerStatus& status);
  void await_exit(Controller& controller);
  std::string failure_of(const Controller& controller) const;

  const std::map<std::string, std::string> values_;
  Session& session_;
  WaitLoop& wait_loop_;
  OnLine on_line_;
  std::vector<Controller> controllers_;
};

}  // namespace visum::run
