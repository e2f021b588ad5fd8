// The scenario's controllers, as processes and as members of the lockstep. Main thread; the runner owns it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "clients/visum/run/scenario.h"
#include "clients/visum/run/session.h"
#include "clients/visum/run/wait_loop.h"
#include "protocol/processes/child_process.h"

namespace visum::run {

struct ControllerResult {
  std::string name;
  std::string end;                      // "exited with code 0", "was stopped at the end"
  std::string failure;                  // empty: it ended well
  std::vector<std::string> last_lines;  // of its output
  bool lost = false;                    // it failed by a signal or by being late, not by an exit code
};

class Controllers {
 public:
  using OnLine = std::function<void(const std::string& controller, const std::string& line)>;

  // `specs` must outlive it. `values` fill the placeholders of the commands.
  Controllers(const std::vector<ControllerSpec>& specs, const std::map<std::string, std::string>& values,
              Session& session, WaitLoop& wait_loop, OnLine on_line);
  ~Controllers();  // stops those that still run, all at once

  // Starts all, and returns when those that join the clock have joined it. Throws ConfigError if a program
  // cannot be started. Throws ExitError if one ends before it joined (kFailed) or does not join in time
  // (kLost).
  void start(double patience_s);

  // Call it while we hold the world. Waits until every member has let the world run on or has left, and until
  // those that have left have ended. So the result does not depend on which program was faster. `status` is
  // the newest one.
  void settle(protocol::ServerStatus status);
  // Notes members that were late, for which the server no longer waits. Depending on `on_timeout` they go on
  // without the clock, or their parts are stopped. Throws ExitError(kLost) if the run ends with it.
  void note_timeouts();
  bool all_joined() const;
  bool any_in_real_time() const;  // whether one that was late still goes on
  // True once all have ended, or have left the clock.
  bool all_done() const;

  // Throws ExitError if one ended badly: kFailed for an exit code, kLost for a signal that the time line did
  // not send.
  void check_ends();
  void signal(const std::string& name, int number);
  void stop_all();
  // Why a controller under the time shim was not in step with the world, as `visum exec` has said; empty: all
  // were, as far as they have ended.
  std::string out_of_step() const;
  std::vector<ControllerResult> results() const;

 private:
  struct Controller {
    const ControllerSpec* spec = nullptr;
    std::unique_ptr<processes::ChildProcess> process;
    bool joins = false, joined = false, left = false;
    bool signalled = false;  // by the time line: its end is no failure
    bool stopped = false;    // by us, at the end
    bool let_go = false;     // it was late and goes on without the clock
    std::string lost;        // the reason, if it was late and its parts were stopped
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
