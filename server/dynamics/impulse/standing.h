// Islands that stand. Where an island of free bodies was frozen (rows_rest.cc), and the tick left it just as
// it was, a tick that is given the same to the last bit leaves it so again, with the same forces. It need not
// be computed.
//
// This is no part of the world's state: it saves work and changes no bit. An engine that does not know the
// tick before, as after a restore, computes the island, with the same result.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/dynamics/impulse/warm_start.h"

namespace visum::dynamics::impulse {

struct IslandFate;

// Order of calls: find(), the tick's one step, note(); or find_none(), and steps of any kind. Stepper owns
// it; tick's thread, but for stands(), stand() and work(), which several threads may call for islands of
// their own. Nothing fails. Allocates only while it grows.
class Standing {
 public:
  explicit Standing(Plant& plant) : plant_(plant) {}

  // Comes when the tick's bodies, islands and records are known. Marks the touches of islands that stand.
  void find(double h, std::span<const collision::Contact> contacts, const WarmStart& warm_start);
  // Nothing stands in this tick, and this tick is nothing to go by in the next one.
  void find_none();
  bool any() const { return any_; }
  bool stands(std::size_t island) const { return any_ && repeats_[island] != kNone; }

  // Gives the bodies of an island that stands their velocities after this moment.
  void stand(std::size_t island, Moment moment);
  // Units of work that the moment took when it was computed: bits depend on how many a tick takes.
  std::uint64_t work(std::size_t island, Moment moment) const {
    return kept_islands_[repeats_[island]].work[moment];
  }

  // The forces of all other contacts are known. Those that stand get theirs, and what the next tick will be
  // compared with is kept. `fates`: by island.
  void note(std::span<collision::Contact> contacts, const WarmStart& warm_start,
            std::span<const IslandFate> fates);

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  struct KeptIsland {
    std::size_t touches = 0;                     // how many
    std::array<std::uint64_t, kMoments> work{};  // units
  };
  struct KeptTouch {
    collision::Contact contact;  // as it was given, and with the forces that came out
    std::array<std::byte, WarmStart::kBytes> record{};
    std::size_t island = 0;  // in kept_islands_
  };

  // Lists grow with the plant's touches, not where something comes to rest.
  void make_room();
  // The kept island that this one repeats, or kNone.
  std::size_t find_repeated(std::size_t island) const;
  bool has_contacts_only(std::size_t island) const;
  // A record that did change matches none in the next tick.
  bool was_left_as_it_was(std::size_t island, std::span<const collision::Contact> contacts) const;

  void give_forces(std::span<collision::Contact> contacts) const;
  void keep_islands(std::span<const collision::Contact> contacts, const WarmStart& warm_start,
                    std::span<const IslandFate> fates);

  Plant& plant_;
  bool notes_ = false, any_ = false;
  double h_ = 0.0;                    // s, of the last tick
  BodiesMotion began_, last_began_;   // where this tick began, and the last one that was noted
  std::vector<std::size_t> repeats_;  // by island: in kept_islands_
  std::vector<std::size_t> match_;    // by touch: in kept_, the one that was given the same
  // The islands of the last tick that may stand in this one, and their touches in the order of contacts.
  // note() makes the next ones.
  std::vector<KeptIsland> kept_islands_, next_islands_;
  std::vector<KeptTouch> kept_, next_;
  std::vector<std::size_t> next_island_;  // by touch: in next_islands_
  std::vector<char> stays_;               // by island: it may stand in the next tick
};

}  // namespace visum::dynamics::impulse
