// Drives the time of a program under the shim. Gives the program's threads their turns, one at a time, and
// lets the world run when all of them wait. The rules are in clients/shim/SPEC.md. Lives on one thread, that
// of `visum exec`.
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "clients/visum/exec/threads.h"
#include "clients/visum/exec/time_channel.h"
#include "clients/visum/exec/world_link.h"
#include "protocol/busy_wait.h"

namespace visum::exec {

class Scheduler {
 public:
  using Clock = std::chrono::steady_clock;

  // `program` is our child. It wakes up at multiples of `period_ticks`. The run ends at `give_up` at the
  // latest.
  Scheduler(TimeChannel& channel, WorldLink& world, pid_t program, std::int64_t period_ticks,
            Clock::time_point give_up);

  // Returns the program's status, in the form of waitpid(), once it has ended. Throws ExitError: kTimedOut,
  // kLost.
  int run();
  // To be called while waiting for the world. False where the program has ended and the world does not
  // answer. Throws as run() does.
  bool is_patient();
  // Ends what is left of the program and of the processes that it started.
  void kill_all();
  // Why the run was not in step with the world: the first process that never loaded the shim, or that waited
  // by the host's time. Empty where all kept in step. Once run() has returned.
  const std::string& out_of_step() const { return out_of_step_; }

 private:
  // Facts about a slot's thread beside those that it writes into its slot.
  struct Watched {
    std::uint32_t turn = 0;  // `go`, when we looked
    std::uint64_t ticks = 0;
    std::uint64_t began = 0;  // `ticks`, when this turn was seen first
    int still = 0;            // looks in a row at which it slept without having announced it
    Clock::time_point still_since = Clock::now();
    std::uint64_t reserved = 0;  // kStarting: the slot's ticket, when it was seen first
    Clock::time_point starting_since = Clock::now();
    bool unknown = false;       // it waits in a call that the shim does not know
    bool awaits_child = false;  // where unknown: for the end of a child
    bool told = false;
    std::optional<Clock::time_point> ended;  // it has ended, and the parent that waits for it still sleeps
  };

  void await_quiet();
  void check_end();
  bool is_quiet(bool& soon);
  bool is_busy(shim::Slot& slot);
  bool is_still(shim::Slot& slot);
  void free_if_gone(shim::Slot& slot);
  bool is_to_wake_parent(const shim::Slot& slot, const ThreadState& state);
  // Looks after the threads that run. True: one of them slept.
  bool watch();
  bool has_run_long(const shim::Slot& slot);
  void look_after(shim::Slot& slot);
  void look_at_wait(const shim::Slot& slot, Watched& watched);
  void drop_if_late(shim::Slot& slot);
  void check_announced(const shim::Slot& slot);  // of a slot whose process is gone
  void await_announcements();
  void note_out_of_step(const std::string& why);
  void complain(shim::Slot& slot);
  void end_program_without_shim();
  shim::Slot* next_ready();
  shim::Slot* next_to_recheck();
  void give_turn(shim::Slot& slot, bool again);
  void note_outcome();
  bool settle_for_one();
  void advance();
  bool advance_by(std::int64_t ticks);
  std::int64_t earliest() const;
  std::int64_t ticks_to(std::int64_t until_ns) const;
  bool any_on_bus();
  bool awaits_answer();
  void ring_alarms();
  std::uint64_t number(const shim::Slot& slot) const {
    return static_cast<std::uint64_t>(&slot - memory_.slots);
  }

  TimeChannel& channel_;
  shim::Shared& memory_;
  WorldLink& world_;
  pid_t program_;
  std::int64_t period_ticks_;
  Clock::time_point give_up_;
  Threads threads_;
  std::array<Watched, shim::kMostThreads> watched_{};
  std::optional<int> ended_;  // the program's status
  Clock::time_point ended_at_;
  protocol::BusyWait busy_wait_;
  std::uint32_t quiet_bell_ = 0;  // the bell, when all waited
  shim::Slot* last_turn_ = nullptr;
  std::int64_t first_watch_ns_;       // after so long we look after the thread that has the turn
  shim::Slot* rechecking_ = nullptr;  // the thread whose turn is only for looking again
  Clock::time_point quiet_since_ = Clock::now();
  Clock::time_point noted_ = Clock::now();
  Clock::time_point started_ = Clock::now();
  std::string out_of_step_;
};

}  // namespace visum::exec
