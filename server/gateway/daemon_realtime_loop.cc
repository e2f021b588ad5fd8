#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <system_error>
#include <thread>

#include "server/cycle/behind_watch.h"
#include "server/gateway/daemon_loop.h"
#include "server/gateway/playback.h"
#include "server/gateway/relief.h"
#include "server/world/exchange.h"

namespace visum::gateway {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLongestSleep{20};  // how soon stop() is noticed while no tick is due
constexpr std::chrono::milliseconds kBeforeTick{1};     // a comparison ends so long before a tick is due
constexpr std::chrono::milliseconds kFarewellLook{5};   // how often the end of the sessions is looked for
constexpr int kMostRounds = 1000;  // of reading what clients sent while the sessions were held up
constexpr std::chrono::milliseconds kBeat{50};  // how often idle sessions show that they are served

// Puts the calling thread before all ordinary ones while it exists. Threads that it starts are ordinary.
class RealtimeThread {
 public:
  explicit RealtimeThread(int priority) {
    if (priority == 0) return;
    const sched_param wanted{priority};
    if (::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) != 0)
      throw std::system_error(errno, std::generic_category(),
                              "--realtime-priority needs the right to it (CAP_SYS_NICE, or ulimit -r)");
    raised_ = true;
  }
  ~RealtimeThread() {
    const sched_param ordinary{0};
    if (raised_) ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  }
  RealtimeThread(const RealtimeThread&) = delete;
  RealtimeThread& operator=(const RealtimeThread&) = delete;

 private:
  bool raised_ = false;
};

// The tick's thread only ever notifies the sessions' thread; it never waits for it.
class RealtimeLoop final : public DaemonLoop {
 public:
  RealtimeLoop(cycle::Simulation& simulation, const DaemonOptions& options, std::atomic<bool>& stop)
      : comparing_(options.playback != nullptr),
        priority_(options.realtime_priority),
        doors_(simulation, options, stop, [this]() -> const Published& { return newest_copy(); }) {
    const RealtimeThread may_be(priority_);  // else it says so before it is ready
    doors_.tick_side.watch_sessions(options.session_silence);
    doors_.tick_side.drop_writes_older_than(options.command_age);
    doors_.gateway.holdup().set_limit(options.command_age);
    doors_.open_buses(options.buses, [this] { doors_.mailbox.wake(); });
    publish(false);
  }

  void run() override;
  DaemonDoors& doors() override { return doors_; }

 private:
  void tick_in_real_time();
  void say_goodbye();
  void read_what_waited();

  // The sessions' thread.
  void serve_sessions();
  const Published& newest_copy() {
    exchange_.refresh();
    return exchange_.front();
  }

  // Puts a copy of the world before the sessions' thread, and wakes it if it has something to send. Commands
  // go back only after that: a client that is told that something is done finds it done in the copy.
  void publish(bool wake) {
    auto& copy = exchange_.back();
    fill(copy, doors_.simulation, doors_.tick_side.pace(), doors_.tick_side.part_table());
    doors_.add_to_copy(copy);
    exchange_.publish();
    doors_.tick_side.give_back();
    published_version_ = doors_.tick_side.version();
    if (wake) doors_.server.notify();
  }

  void wait_until(Clock::time_point due) {
    const config::ProfileScope waits(doors_.profile, config::Profile::kWait);
    if (doors_.wait) return doors_.wait(due);
    if (!doors_.buses.are_open()) return sleep_until(due);
    doors_.buses.serve_until(due);
  }

  // A recording is compared while there is nothing else to do, up to `until`.
  void compare_until(Clock::time_point until) {
    while (comparing_ && Clock::now() < until) comparing_ = doors_.playback->compare();
  }

  world::Exchange<Published> exchange_;
  cycle::BehindWatch behind_;
  std::atomic<bool> sessions_ended_{false};
  std::uint64_t published_version_ = 0;  // of the tick's side, as of the last copy
  bool comparing_;                       // parts of the recording are not compared yet
  const int priority_;
  DaemonDoors doors_;  // last: while it ends, sessions may still ask for the copy
};

// The sessions' thread is told of the end in any case, also where a tick throws.
void RealtimeLoop::run() {
  prctl(PR_SET_TIMERSLACK, 1UL);
  std::thread sessions([this] { serve_sessions(); });
  std::exception_ptr failure;
  try {
    const RealtimeThread undisturbed(priority_);
    const Relief relief({.is_to_end = [this] { return doors_.end_asked(); },
                         .tick = [this] { return doors_.simulation.working().tick(); },
                         .abandon = [this](auto tick) { doors_.abandon(tick, [this] { say_goodbye(); }); }});
    tick_in_real_time();
  } catch (...) {
    failure = std::current_exception();
  }
  if (doors_.profile) doors_.profile->enter(config::Profile::kEnd);
  doors_.gateway.end();
  doors_.server.notify();
  doors_.server.stop();
  sessions.join();
  if (failure) std::rethrow_exception(failure);
}

void RealtimeLoop::serve_sessions() {
  while (!doors_.server.ended()) {
    doors_.server.poll_for(kBeat);
    doors_.gateway.beat();
    read_what_waited();
  }
  sessions_ended_.store(true);
}

// After a time in which this thread did not run: reads all that clients have sent meanwhile.
void RealtimeLoop::read_what_waited() {
  auto& holdup = doors_.gateway.holdup();
  if (holdup.age().count() == 0) return;
  for (int rounds = 0; rounds < kMostRounds && doors_.server.poll(); ++rounds) {
  }
  holdup.end();
}

// On the relief's thread, while a tick is abandoned.
void RealtimeLoop::say_goodbye() {
  doors_.gateway.end();
  doors_.server.notify();
  doors_.server.stop();
  const auto patience = Clock::now() + Relief::kFarewell;
  while (!sessions_ended_.load() && Clock::now() < patience) std::this_thread::sleep_for(kFarewellLook);
}

void RealtimeLoop::tick_in_real_time() {
  auto& tick_side = doors_.tick_side;
  auto& pacer = tick_side.pacer();
  bool was_running = false;
  if (doors_.profile) doors_.profile->enter(config::Profile::kGateway);
  while (!doors_.ended()) {
    tick_side.empty_mailbox();
    tick_side.look_at_sessions();
    doors_.buses.serve();
    if (doors_.gateway.lockstep().start_asked()) tick_side.start();
    const bool runs = tick_side.time_runs();
    if (runs && !was_running) tick_side.go_on(Clock::now());
    if (published_version_ != tick_side.version() || runs != was_running) publish(true);
    was_running = runs;
    if (!runs) {
      compare_until(Clock::now() + kLongestSleep);
      const config::ProfileScope waits(doors_.profile, config::Profile::kWait);
      doors_.mailbox.wait_for(comparing_ ? std::chrono::milliseconds(0) : kLongestSleep);
      continue;
    }
    // A tick that is far off is waited for in pieces. Commands are done in between, and may change when it is
    // due.
    const auto until = std::min(pacer.due(), Clock::now() + kLongestSleep);
    compare_until(until - kBeforeTick);
    wait_until(until);
    if (until < pacer.due()) continue;
    tick_side.empty_mailbox();
    const auto began = Clock::now();
    pacer.begin_tick(began);
    if (const auto line = behind_.look(began, pacer.lost(), pacer.overruns())) spdlog::warn("{}", *line);
    const auto version_before = published_version_;
    tick_side.tick();
    doors_.after_tick();
    publish(doors_.has_something_to_send() || version_before != tick_side.version());
  }
}

}  // namespace

std::unique_ptr<DaemonLoop> make_realtime_loop(cycle::Simulation& simulation, const DaemonOptions& options,
                                               std::atomic<bool>& stop) {
  return std::make_unique<RealtimeLoop>(simulation, options, stop);
}

}  // namespace visum::gateway
