// A mirror: two arms behind one part, which get the same commands.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/mirror/arm_link.h"
#include "server/mirror/world_link.h"

namespace visum::mirror {

struct MirrorBounds {
  // The divergence that raises a fault; 0: none does.
  double angle_limit_rad = 0.0;
  double position_limit_m = 0.0;
  // The divergence up to which the primary may be switched without force.
  double angle_switch_rad = 0.02;
  double position_switch_m = 0.002;
};

// An arm that is away, and which commands must not be given without it. Aligned, since Clang would otherwise
// call a library for the atomic.
struct alignas(2) AwayArm {
  enum class Misses : std::uint8_t { kNothing, kCounters, kEverything };
  std::uint8_t arm = 0;
  Misses misses = Misses::kNothing;
};
static_assert(std::atomic<AwayArm>::is_always_lock_free);

// The controller sees the primary arm. The divergence of the two is watched port by port. Both arms are
// halted when the divergence exceeds its limit, or when one of them refuses a command. They stand until the
// controller's Reset; so does an arm that was away or started anew meanwhile. The primary can be switched
// live. All calls come from one thread, apart from refuse_now(). The program visum-mirror owns it.
class Mirror {
 public:
  static constexpr std::size_t kArms = 2;

  // Throws std::runtime_error where an arm cannot be reached, or the two do not have the same ports.
  Mirror(const std::array<std::string, kArms>& addresses, const std::string& part, const Entry& entry);

  // The description of the mirrored part: that of the primary at the start.
  const protocol::PartDescription& description() const { return description_; }
  bool simulated() const { return arms_[0].simulated() && arms_[1].simulated(); }
  std::int64_t tick_ns() const { return arms_[0].tick_ns(); }
  const std::string& identity() const { return identity_; }

  // Takes in what came from both arms, and checks the divergence. Does not wait.
  void pump();
  // Waits for something to come, at most until `due`.
  void wait_until(std::chrono::steady_clock::time_point due);
  // Sends the inputs to both arms. Raises a fault where an arm that is away misses a command that
  // refuse_now() did not refuse, because it did not know yet.
  void command(std::span<const double> inputs);
  // Why the change in these inputs cannot be commanded just now: an arm that is away would miss it, and must
  // not carry it out late. A Halt can always be commanded. Any thread.
  std::optional<std::string> refuse_now(std::span<const double> before, std::span<const double> inputs) const;
  void controller_lost();
  // The primary's sensor outputs, with the mirror's own faults in `Part State`.
  void read(std::span<double> outputs) const;

  // Ports that are compared (positions), and how far the shadow is from the primary at each of them.
  std::span<const std::size_t> compared() const { return compared_; }
  std::span<const double> divergence() const { return divergence_; }
  double largest(const char* unit) const;  // the largest amount in "rad" or "m"
  bool fault() const { return fault_; }
  const std::string& why() const { return why_; }  // the last fault
  std::uint64_t refusals(std::size_t arm) const { return arms_[arm].refusals(); }
  bool connected(std::size_t arm) const { return arms_[arm].connected(); }
  std::size_t primary() const { return primary_; }
  // The arm whose world is shown: that of the primary at the start if it has one, else the other's; none:
  // neither has a world.
  std::optional<std::size_t> world_of() const { return world_of_; }
  void show_world(gateway::Published& published) const;
  // Returns the reason where it is refused.
  std::optional<std::string> switch_to(std::size_t arm, bool by_force);
  MirrorBounds& bounds() { return bounds_; }

  // The primary's parameters, and `Emergency Stop` also where only the other arm has it.
  std::vector<protocol::Parameter> parameters();
  // Sets it for both arms or for none. But an emergency stop goes to each arm that is there, and an arm that
  // has no such parameter is halted. Returns the reason where it failed.
  std::optional<std::string> set_parameter(const std::string& name, const protocol::ParameterValue& value);

 private:
  void check_alike() const;
  // Updates the divergence, and raises a fault when it exceeds its limit.
  void compare();
  // Raises a fault where an arm has refused a command.
  void hear_refusals();
  void find_world(const Entry& entry);
  // Notes a fault, and halts both arms until the controller's Reset.
  void raise(const std::string& why);
  // Halts both arms by counting their input `Halt`.
  void halt();
  // Joins the counters of an arm that was found again, or whose inputs were put back.
  void take_up(ArmLink& arm);
  AwayArm look_who_is_away() const;
  bool misses_something(AwayArm away, std::span<const double> before, std::span<const double> inputs) const;
  std::optional<std::string> set_emergency_stop(const protocol::ParameterValue& value);
  std::vector<double> commanded() const;  // with the mirror's own halts
  void send();

  std::array<ArmLink, kArms> arms_;
  protocol::PartDescription description_;
  std::string identity_;
  std::vector<std::size_t> compared_;
  std::vector<double> divergence_;
  std::size_t halt_ = 0, reset_ = 0;       // of the controller inputs
  std::optional<std::size_t> part_state_;  // of the sensor outputs
  std::vector<double> initial_, inputs_;   // at the start, and as last commanded
  double halts_ = 0.0;                     // by the mirror itself
  bool halted_ = false;                    // by the mirror or the controller, since the last Reset
  std::atomic<AwayArm> away_{AwayArm{}};   // at the last pump()
  MirrorBounds bounds_;
  std::size_t primary_ = 0;
  bool fault_ = false;
  std::string why_;
  std::optional<WorldLink> world_;
  std::optional<std::size_t> world_of_;
  std::array<std::uint64_t, kArms> refusals_seen_{};
  bool exceeded_ = false;  // whether compare() found the limit exceeded last
};

}  // namespace visum::mirror
