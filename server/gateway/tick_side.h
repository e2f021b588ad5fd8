// The gateway's counterpart on the tick's thread: empties the mailbox between ticks, gives the world its
// inputs in a fixed order, answers commands, and decides whether time runs at all. The loop in daemon.cc owns
// it. It never waits. A refused push or fault becomes a notice to the sessions' side; a refused command
// becomes its reply.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "server/cycle/pacer.h"
#include "server/cycle/simulation.h"
#include "server/gateway/body_changes.h"
#include "server/gateway/holders.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/published.h"
#include "server/gateway/session_watch.h"
#include "server/gateway/stop_latch.h"

namespace visum::gateway {

class TickSide {
 public:
  // `running_at_once`: time runs from the beginning. Otherwise it starts with the first lease, the first step
  // of a member, or Resume.
  // `archive`: what clients keep on disk; null: nothing.
  TickSide(cycle::Simulation& simulation, Mailbox& mailbox, bool running_at_once,
           recording::Archive* archive = nullptr);

  // Takes everything out of the mailbox. Commands are done at once, inputs wait for the next tick.
  void empty_mailbox();
  // Gives done commands back to the sessions' side. Call it after the world was published: the sessions' side
  // answers the next request from that copy, which must not be older than the command.
  void give_back();

  // Emergency stops come this way. They act before anything else that waits, also between two commands.
  StopLatch& stops() { return stops_; }
  // Clock realtime: from now on, look_at_sessions() stops the parts that sessions command once the sessions'
  // thread has been silent for so long. 0: never.
  void watch_sessions(std::chrono::milliseconds limit) { session_watch_.set_limit(limit); }
  // Clock realtime: to be called each time that the loop comes round.
  void look_at_sessions();
  // Clock realtime: from now on, writes that are older than this are dropped. 0: none.
  void drop_writes_older_than(std::chrono::milliseconds age) { oldest_write_ = age; }
  std::uint64_t dropped_writes() const { return dropped_writes_; }
  // Clock realtime: time runs again from now on. A write that came while it stood is not old.
  void go_on(std::chrono::steady_clock::time_point now) {
    pacer_.restart(now);
    runs_since_ = now;
  }
  std::uint64_t silent_stops() const { return silent_stops_; }  // parts that were stopped that way

  // From now on the ticks come from a recording. `next` makes the next one and returns false at the end;
  // `era` returns the era that clients are shown.
  void play(std::function<bool()> next, std::function<std::uint64_t()> era) {
    next_ = std::move(next);
    shown_era_ = std::move(era);
  }

  // One tick: the inputs first, in their order, then the cycle.
  void tick();

  // False while the world is frozen or paused, or has not started. A Step in progress overrides the last two.
  bool time_runs() const { return !simulation_.frozen() && (started_ && !paused_ ? true : steps_left_ > 0); }
  // True while a change of the bodies is made ready and the world must not go on before it: in lockstep and
  // free, so that the tick at which it acts does not depend on how busy this machine is. Commands and inputs
  // that came later stay in the mailbox. In real time the ticks go on.
  bool waits_for_change() const { return waits_for_changes_ && changes_.under_way(); }
  bool change_under_way() const { return changes_.under_way(); }  // also in real time
  // `wake` is called on another thread when such a change is ready: empty_mailbox() then carries it out.
  void on_change_ready(std::function<void()> wake) { changes_.on_ready(std::move(wake)); }
  // Ends that thread, which finishes the change that it is at.
  void end_changes() { changes_.end(); }
  bool stepping() const { return steps_left_ > 0; }
  void start() {  // at the first lease, the first step of a member, or Resume
    if (!std::exchange(started_, true)) ++version_;
  }
  Pace pace() const { return {!started_ || paused_, pacer_.speed(), real_time_factor_}; }
  // Changes with everything that shows between ticks: start, pauses, commands. The loop then publishes anew.
  std::uint64_t version() const { return version_; }
  void touch() { ++version_; }  // something beside the mailbox changed the world between ticks

  // When the last tick ended.
  std::chrono::steady_clock::time_point ticked_at() const { return ticked_at_; }

  // True once after a notice or a finished Step was given to the sessions' side, which then has to send it.
  bool has_told() { return std::exchange(told_, false); }

  // See BodyChanges.
  void serve_models(std::filesystem::path folder, cycle::SceneOrder scenes) {
    changes_.serve_models(std::move(folder), std::move(scenes));
  }
  void refuse_scenes(std::function<std::string()> why) { changes_.refuse_scenes(std::move(why)); }
  // The numbers of the parts. `changed` is called on the tick's thread when models come or go.
  const std::shared_ptr<const PartTable>& part_table() const { return numbers_.table(); }
  void on_parts_changed(std::function<void(const PartTable&)> changed) {
    parts_changed_ = std::move(changed);
  }
  // A tick will never end, on another thread than the tick's: completes the recording that a client started.
  void close_recording() { changes_.close_recording(); }

  cycle::Pacer& pacer() { return pacer_; }
  const cycle::Pacer& pacer() const { return pacer_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Watch {  // the deadline of a part's lease
    std::uint64_t epoch = 0;
    std::int64_t deadline_ticks = 0;  // 0: none
    std::int64_t last_tick = 0;       // of the last write
    bool leased = false;
    std::uint64_t lost = 0;  // epoch of the newest lost lease; its writes that come later are dropped
  };

  struct WatchedNode {  // a part that a plug-in brings
    const hwparts::Part* part;
    bool failed = false;
  };

  // Pauses where a recording ends.
  void hold();
  // Applies the waiting inputs, sorted so that it does not matter which of two clients' bytes came first.
  void apply_inputs();
  void apply(const Input& input);
  // True: the write has waited for so long, while time ran, that it is not done.
  bool is_too_old(const Input& write) const;
  void apply_fault(const Input& input, std::uint32_t part);
  void apply_push(const Input& input);
  // Models may have come or gone, or another scene: gives their parts numbers.
  void follow_parts();
  // Looks for nodes of plug-ins among the parts.
  void find_nodes();
  // The part that the command is about; null: it is gone, and the command's reply says so.
  cycle::BoundPart* part_or_fail(Command& command);
  std::size_t number_of(const cycle::BoundPart& bound) const {
    return static_cast<std::size_t>(&bound - simulation_.parts().data());
  }
  // Stops each part that was pressed since the last time.
  void obey_stops();
  void stop(std::uint32_t part);
  // Takes the part from each controller that has not written within its deadline.
  void check_deadlines();
  // Takes the part from its controller, and tells the sessions' side why.
  void take_from_controller(std::uint32_t part, Notice::Kind why);
  // Ends the part's deadline, and drops later writes of this lease and those before it.
  void end_watch(std::uint32_t part, std::uint64_t lost_epoch);
  // Answers a command, or begins a Step, which is answered by finish_steps().
  void run(std::unique_ptr<Command> command);
  // Carries out the changes of the bodies that are ready, and answers them.
  void finish_changes();
  // Replies to the running Step: all its ticks are done, or something stopped the time.
  void finish_steps();
  // Renews the real-time factor about once a second.
  void measure_speed();
  // Logs, once, that a plug-in's node has failed.
  void watch_nodes();
  void tell(Notice notice);

  // True for requests that undo what was done to the parts.
  static bool goes_back(const protocol::Request& request);
  // After a reset or restore: deadlines begin anew.
  void time_went_back();

  // The answers to commands are in tick_side_commands.cc.
  protocol::Reply answer(Command& command, const protocol::Pause&);
  protocol::Reply answer(Command& command, const protocol::Resume&);
  protocol::Reply answer(Command& command, const protocol::SetSpeed& request);
  protocol::Reply answer(Command& command, const protocol::Reset& request);
  protocol::Reply answer(Command& command, const protocol::SetBody& request);
  protocol::Reply answer(Command& command, const protocol::SetJoints& request);
  protocol::Reply answer(Command& command, const protocol::PullBody& request);
  protocol::Reply answer(Command& command, const protocol::ReleaseBody& request);
  protocol::Reply answer(Command& command, const protocol::TakeSnapshot&);
  protocol::Reply answer(Command& command, const protocol::RestoreSnapshot& request);
  protocol::Reply answer(Command& command, const protocol::GetParameters&);
  protocol::Reply answer(Command& command, const protocol::SetParameter& request);
  protocol::Reply answer(Command& command, const protocol::ReadBlackboard& request);
  protocol::Reply answer(Command& command, const protocol::WriteBlackboard& request);
  protocol::Reply answer(Command& command, const protocol::UnlockBlackboard& request);
  template <typename Other>
  protocol::Reply answer(Command& command, const Other& request);

  cycle::Simulation& simulation_;
  Mailbox& mailbox_;
  cycle::Pacer pacer_;
  std::function<bool()> next_;                // empty: the world makes its own ticks
  std::function<std::uint64_t()> shown_era_;  // empty: the world's own era
  PartNumbers numbers_;
  std::function<void(const PartTable&)> parts_changed_;  // empty: nobody wants to know
  BodyChanges changes_;
  const bool waits_for_changes_;  // not in real time
  std::vector<Input*> inputs_;    // for the next tick
  std::vector<Watch> watches_;    // by number of the part
  Holders holders_;
  StopLatch stops_;
  std::vector<std::uint32_t> stopped_;            // since the mailbox was emptied last
  std::vector<std::uint32_t> stopped_meanwhile_;  // while a change of the bodies was made ready
  SessionWatch session_watch_;
  std::uint64_t silent_stops_ = 0;
  std::chrono::milliseconds oldest_write_{0};
  std::uint64_t dropped_writes_ = 0;
  Clock::time_point runs_since_{};
  std::vector<WatchedNode> nodes_;
  std::vector<std::uint64_t> trips_;            // by part, as last looked at
  std::unique_ptr<Command> step_command_;       // the running Step; null: none
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
