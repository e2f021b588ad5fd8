// Where the wall time of a thread goes: at each moment it belongs to exactly one phase, so that the phases
// add up to the whole. A program that is not measured has no Profile, and pays for one test of a pointer. One
// thread, the one that is measured; its owner makes it and writes it down in the end.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace visum::config {

class Profile {
 public:
  using Clock = std::chrono::steady_clock;
  using Phase = std::uint8_t;
  // The phases of a daemon; see clients/visum/PROFILE.md. Others are added by add().
  enum : Phase {
    kLoad,
    kGateway,
    kWait,
    kParts,
    kAgents,
    kDrives,
    kCollision,
    kPhysics,
    kRecording,
    kHash,
    kEnd,
    kFixed
  };
  static constexpr std::size_t kMostPhases = 32;

  struct Time {
    std::string name;
    std::int64_t ns = 0;
    std::int64_t times = 0;  // how often the phase began
  };

  // Keeps up to `most_spans` spans for write_spans(), and only sums after these. Begins with kLoad.
  explicit Profile(std::size_t most_spans);

  // The phase of that name, which is new if there is none. Where kMostPhases are taken: kWait.
  Phase add(std::string_view name);
  // From now on time belongs to `phase`. Returns the phase to which it belonged before.
  Phase enter(Phase phase);
  // Around each tick. The phases within a run are counted from the first call of tick_begins() to the last of
  // tick_ended(); what is before and after belongs to the start and the end.
  void tick_begins();
  void tick_ended();

  std::int64_t ticks() const { return ticks_; }
  std::int64_t began_ns() const { return began_ns_; }            // when it was made; of the steady clock
  std::int64_t first_tick_ns() const { return first_tick_ns_; }  // 0: there was no tick
  std::int64_t last_tick_ns() const { return last_tick_ns_; }
  bool keeps_spans() const { return most_spans_ > 0; }
  std::size_t left_out() const { return left_out_; }  // spans beyond `most_spans`
  // The phases between the first and the last tick, those with any time in them.
  std::vector<Time> run() const;
  // All phases since it was made.
  std::vector<Time> whole() const { return times_of({}, sums_); }

  // A line for each span, as an event of the Trace Event Format that Perfetto reads, with a comma behind it.
  // Times are those of the steady clock.
  void write_spans(std::ostream& out, std::int64_t process) const;

 private:
  struct Sum {
    std::int64_t ns = 0, times = 0;
  };
  using Sums = std::array<Sum, kMostPhases>;
  struct Span {
    std::int64_t from_ns;
    Phase phase;
  };
  std::vector<Time> times_of(const Sums& from, const Sums& to) const;
  void count_until(std::int64_t now_ns);

  const std::size_t most_spans_;
  std::vector<std::string> names_;
  Sums sums_{}, at_first_tick_{}, at_last_tick_{};
  std::vector<Span> spans_;
  std::size_t left_out_ = 0;
  std::int64_t ticks_ = 0, began_ns_, since_ns_, first_tick_ns_ = 0, last_tick_ns_ = 0;
  Phase phase_ = kLoad;
};

// Measures `phase` from here to the end of the block, and goes back to the phase before. Null: does nothing.
class ProfileScope {
 public:
  ProfileScope(Profile* profile, Profile::Phase phase)
      : profile_(profile), before_(profile ? profile->enter(phase) : phase) {}
  ~ProfileScope() {
    if (profile_) profile_->enter(before_);
  }
  ProfileScope(const ProfileScope&) = delete;
  ProfileScope& operator=(const ProfileScope&) = delete;

 private:
  Profile* const profile_;
  const Profile::Phase before_;
};

// Two events for the same file: the names of a process and of its measured thread. A comma is behind each.
std::string name_events(std::int64_t process, std::string_view name, std::string_view thread);

}  // namespace visum::config
