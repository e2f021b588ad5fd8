#include <sys/prctl.h>

#include <utility>

#include "server/gateway/daemon_loop.h"
#include "server/gateway/relief.h"

namespace visum::gateway {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kIdle{20};          // how soon stop() is noticed while no tick is due
constexpr std::chrono::milliseconds kPaceLook{1};       // sessions of a paced lockstep are served that often
constexpr std::chrono::microseconds kTickingLook{100};  // and those of a world that ticks as fast as it can
constexpr std::chrono::seconds kFarewell{2};            // for clients that read their last frames slowly
// The relief shows a copy of the world. It is made before each tick where ticks take so long that a copy
// costs nothing. Otherwise it may be a little older.
constexpr std::chrono::milliseconds kSlowTick{1}, kOldCopy{50};

// One thread ticks and serves the sessions. In lockstep, waking another thread for each step would cost more
// than the step itself. While a tick takes long, the relief's thread serves them instead: from the copy of
// the world that was made last, since the world itself is being changed.
class InlineLoop final : public DaemonLoop {
 public:
  InlineLoop(cycle::Simulation& simulation, const DaemonOptions& options, std::atomic<bool>& stop)
      : paced_(options.paced && simulation.scene().clock == scene::ClockKind::kLockstep),
        doors_(simulation, options, stop, [this]() -> const Published& { return fresh_copy(); }) {
    doors_.gateway.set_profile(options.profile);
    doors_.open_buses(options.buses, [this] { doors_.server.notify(); });
  }

  void run() override;
  DaemonDoors& doors() override { return doors_; }

 private:
  // True if the world may tick now.
  bool may_tick();
  // False: the next tick's time has not come yet; sessions are served meanwhile.
  bool await_due();
  bool stands() const;  // true if the lockstep lets no further tick be made now
  // Lets go of the sessions while `work` is done, which must not touch them.
  template <typename Work>
  void without_sessions(Relief& relief, const Work& work);
  void tick(Relief& relief);
  // Serves the sessions, and waits for them if they send nothing.
  void await_sessions();
  void end_sessions(std::chrono::milliseconds farewell);
  Relief::Duties duties_of_relief();
  void relieve(bool begins);
  // The copy is made when it is asked for, and only if something happened since the last time.
  const Published& fresh_copy();

  const bool paced_;
  bool is_paced_now_ = false;
  Published copy_;
  std::uint64_t copied_version_ = 0;  // of the tick's side
  Clock::time_point copied_at_{}, last_tick_at_{};
  bool relieved_ = false;  // changes hands together with the sessions
  DaemonDoors doors_;      // last: while it ends, sessions may still ask for the copy
};

const Published& InlineLoop::fresh_copy() {
  if (relieved_) return copy_;
  const auto& simulation = doors_.simulation;
  const auto version = doors_.tick_side.version();
  if (copy_.tick != simulation.tick_count() || copy_.era != simulation.era() || copied_version_ != version ||
      copy_.fault.empty() == simulation.frozen()) {
    fill_unhashed(copy_, simulation, doors_.tick_side.pace(), doors_.tick_side.part_table());
    doors_.add_to_copy(copy_);
    copied_version_ = version;
    copied_at_ = doors_.tick_side.ticked_at();
  }
  return copy_;
}

template <typename Work>
void InlineLoop::without_sessions(Relief& relief, const Work& work) {
  struct Absence {
    explicit Absence(InlineLoop& its_loop, Relief& its_relief) : loop(its_loop), relief(its_relief) {
      relief.leave();
    }
    ~Absence() {
      if (relief.take_back()) loop.doors_.tick_side.touch();
    }
    InlineLoop& loop;
    Relief& relief;
  };
  const Absence absence(*this, relief);
  work();
}

void InlineLoop::tick(Relief& relief) {
  const auto now = doors_.tick_side.ticked_at();
  if (now - std::exchange(last_tick_at_, now) > kSlowTick || now - copied_at_ > kOldCopy) {
    fresh_copy();
    copy_.state_hash = state_hash(copy_);
    copy_.hashed_by = nullptr;
  }
  without_sessions(relief, [this] { doors_.tick_side.tick(); });
  doors_.after_tick();
}

// The hash cannot be asked for while the world is being changed.
void InlineLoop::relieve(bool begins) {
  relieved_ = begins;
  if (begins && std::exchange(copy_.hashed_by, nullptr)) copy_.state_hash = 0;
  doors_.gateway.relieve(begins);
}

Relief::Duties InlineLoop::duties_of_relief() {
  return {
      .relieve = [this](bool begins) { relieve(begins); },
      .serve =
          [this](std::chrono::nanoseconds at_most) {
            doors_.server.poll_for(at_most);
            doors_.gateway.beat();
          },
      .wake = [this] { doors_.server.notify(); },
      .is_to_end = [this] { return doors_.end_asked(); },
      .tick = [this] { return relieved_ ? doors_.simulation.working().tick() : 0; },
      .abandon = [this](auto tick) { doors_.abandon(tick, [this] { end_sessions(Relief::kFarewell); }); }};
}

bool InlineLoop::may_tick() {
  auto& tick_side = doors_.tick_side;
  auto& lockstep = doors_.gateway.lockstep();
  if (lockstep.start_asked()) tick_side.start();
  if (tick_side.waits_for_change()) return is_paced_now_ = false;
  if (!tick_side.time_runs()) {
    lockstep.end_waits();
    return is_paced_now_ = false;
  }
  if (doors_.simulation.scene().clock == scene::ClockKind::kFree) return true;
  const auto tick = doors_.simulation.tick_count();
  if (lockstep.lets(tick, tick_side.stepping())) return await_due();
  is_paced_now_ = false;
  doors_.gateway.check_timeouts(tick);
  return false;
}

bool InlineLoop::stands() const {
  const auto tick = doors_.simulation.tick_count();
  return doors_.simulation.scene().clock == scene::ClockKind::kLockstep &&
         !doors_.gateway.lockstep().lets(tick, doors_.tick_side.stepping());
}

bool InlineLoop::await_due() {
  if (!paced_ && !doors_.gateway.lockstep().has_dropped()) return true;
  auto& pacer = doors_.tick_side.pacer();
  if (!std::exchange(is_paced_now_, true)) pacer.restart(Clock::now());
  const auto left = pacer.due() - Clock::now();
  if (left > kPaceLook) return false;
  if (left > Clock::duration::zero()) {
    const config::ProfileScope waits(doors_.profile, config::Profile::kWait);
    sleep_until(pacer.due());
  }
  pacer.begin_tick(Clock::now());
  return true;
}

void InlineLoop::await_sessions() {
  config::Profile::Phase waits = config::Profile::kWait;
  if (doors_.profile) {
    const auto holder = doors_.gateway.lockstep().held_by(doors_.simulation.tick_count());
    if (!holder.empty()) waits = doors_.profile->add("waits for " + std::string(holder));
  }
  const config::ProfileScope measured(doors_.profile, waits);
  doors_.server.poll_for(is_paced_now_ ? kPaceLook : kIdle);
}

void InlineLoop::run() {
  if (doors_.profile) doors_.profile->enter(config::Profile::kGateway);
  if (paced_) prctl(PR_SET_TIMERSLACK, 1UL);
  auto& tick_side = doors_.tick_side;
  auto& gateway = doors_.gateway;
  auto& server = doors_.server;
  fresh_copy();  // for a first tick that takes long
  Relief relief(duties_of_relief());
  auto now = Clock::now(), polled = now - kTickingLook;
  while (!doors_.ended()) {
    if (now - polled >= kTickingLook && !doors_.mailbox.has_items()) {
      server.poll();
      polled = now;
    }
    const auto version = tick_side.version();
    without_sessions(relief, [&] { tick_side.empty_mailbox(); });
    tick_side.give_back();
    // Members learn of a reset before anything else: the ticks that they granted were of the era before.
    if (version != tick_side.version()) gateway.serve();
    if (doors_.buses.serve()) tick_side.touch();
    // Each answer may bring the next request of that member, as often as it has sent some ahead.
    while (gateway.lockstep().follow_members(doors_.simulation.tick_count())) gateway.serve();
    if (gateway.lockstep().follow_buses(doors_.simulation.tick_count())) gateway.serve();
    if (may_tick()) {
      if (gateway.complete_writes()) tick_side.empty_mailbox();
      if (doors_.wait) doors_.wait(Clock::now());
      const auto before_tick = tick_side.version();
      tick(relief);
      tick_side.give_back();
      now = tick_side.ticked_at();
      if (before_tick == tick_side.version() && !doors_.has_something_to_send()) continue;
      gateway.serve();
      // Where the world now stands, the mailbox comes next, and its answers leave together with these.
      if (!(doors_.mailbox.has_items() && stands())) server.write();
    } else {
      gateway.serve();
      const bool more = doors_.mailbox.has_items();
      if (!more) await_sessions();
      now = Clock::now();
      if (!more) polled = now;
    }
  }
  if (doors_.profile) doors_.profile->enter(config::Profile::kEnd);
  end_sessions(kFarewell);
}

void InlineLoop::end_sessions(std::chrono::milliseconds farewell) {
  doors_.gateway.end();
  doors_.gateway.serve();
  doors_.server.stop();
  const auto patience = Clock::now() + farewell;
  while (!doors_.server.ended() && Clock::now() < patience) doors_.server.poll_for(kIdle);
}

}  // namespace

std::unique_ptr<DaemonLoop> make_inline_loop(cycle::Simulation& simulation, const DaemonOptions& options,
                                             std::atomic<bool>& stop) {
  return std::make_unique<InlineLoop>(simulation, options, stop);
}

}  // namespace visum::gateway
