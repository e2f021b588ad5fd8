// The tick's side of the gateway: what is done with the mailbox between ticks, and whether time runs at all.
// Lives on the tick's thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "server/cycle/pacer.h"
#include "server/cycle/simulation.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/published.h"

namespace visum::gateway {

class TickSide {
 public:
  TickSide(cycle::Simulation& simulation, Mailbox& mailbox, bool running_at_once);

  // Takes everything out of the mailbox: commands are done at once, inputs are kept for the next tick.
  void empty_mailbox();
  // Commands that are done go back to the sessions' side. Once it has a copy of the world that is as late:
  // what it answers next is read from that.
  void give_back();

  // Ticks are those of a recording from now on, by `next`, which tells whether there was one; `era` is the
  // one that clients are shown.
  void play(std::function<bool()> next, std::function<std::uint64_t()> era) {
    next_ = std::move(next);
    shown_era_ = std::move(era);
  }

  // One tick: the inputs first, in their order, then the cycle.
  void tick();

  // True if neither a pause nor a fault nor a start still to come holds the time.
  bool time_runs() const { return !simulation_.frozen() && (started_ && !paused_ ? true : steps_left_ > 0); }
  bool stepping() const { return steps_left_ > 0; }
  void start() {  // first lease, first step of a member, resume
    if (!std::exchange(started_, true)) ++version_;
  }
  Pace pace() const { return {!started_ || paused_, pacer_.speed(), real_time_factor_}; }
  // Changes with everything that a tick does not announce by itself: start, pauses, commands.
  std::uint64_t version() const { return version_; }
  void touch() { ++version_; }  // something beside the mailbox changed the world between ticks

  // When the last tick was over.
  std::chrono::steady_clock::time_point ticked_at() const { return ticked_at_; }

  // True once after the tick's side gave something to the sessions' side that waits to be sent on.
  bool has_told() { return std::exchange(told_, false); }

  cycle::Pacer& pacer() { return pacer_; }
  const cycle::Pacer& pacer() const { return pacer_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Watch {  // a lease with a deadline
    std::uint64_t epoch = 0;
    std::int64_t deadline_ticks = 0;  // 0: none
    std::int64_t last_tick = 0;
    std::uint64_t lost = 0;  // the newest lease that was lost: what was still on its way is not done
  };

  struct WatchedNode {  // of a plug-in
    const hwparts::Part* part;
    bool failed = false;
  };

  void hold();
  void apply_inputs();
  void apply(const Input& input);
  void apply_push(const Input& input);
  void check_deadlines();
  void end_watch(std::uint32_t part, std::uint64_t lost_epoch);
  void run(std::unique_ptr<Command> command);
  void finish_steps();
  void measure_speed();
  void watch_nodes();
  void tell(const Notice& notice);

  protocol::Reply answer(Command& command, const protocol::Pause&);
  protocol::Reply answer(Command& command, const protocol::Resume&);
  protocol::Reply answer(Command& command, const protocol::SetSpeed& request);
  protocol::Reply answer(Command& command, const protocol::Reset&);
  protocol::Reply answer(Command& command, const protocol::TakeSnapshot&);
  protocol::Reply answer(Command& command, const protocol::RestoreSnapshot& request);
  protocol::Reply answer(Command& command, const protocol::AddBody& request);
  protocol::Reply answer(Command& command, const protocol::RemoveBody& request);
  protocol::Reply answer(Command& command, const protocol::GetParameters&);
  protocol::Reply answer(Command& command, const protocol::SetParameter& request);
  protocol::Reply answer(Command& command, const protocol::ReadBlackboard& request);
  protocol::Reply answer(Command& command, const protocol::WriteBlackboard& request);
  template <typename Other>
  protocol::Reply answer(Command& command, const Other& request);

  cycle::Simulation& simulation_;
  Mailbox& mailbox_;
  cycle::Pacer pacer_;
  std::function<bool()> next_;                // none: the world's own tick
  std::function<std::uint64_t()> shown_era_;  // none: the world's own era
  std::vector<Input*> inputs_;                // for the next tick
  std::vector<Watch> watches_;                // by part
  std::vector<WatchedNode> nodes_;
  std::unique_ptr<Command> step_command_;
  std::vector<std::unique_ptr<Command>> done_;  // to be given back
  std::int64_t steps_left_ = 0;
  bool started_;
  bool paused_ = false;
  std::uint64_t version_ = 0;
  bool told_ = false;
  double real_time_factor_ = 0.0;
  Clock::time_point measured_at_ = Clock::now(), ticked_at_ = measured_at_;
  std::int64_t measured_tick_ = 0;
};

}  // namespace visum::gateway
