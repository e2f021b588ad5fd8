// Lets the engines of one world share loads where their bodies touch. An engine sees bodies of others move as
// they move, whatever presses them. So contacts between bodies of two engines are taken away from both, and
// stand here: an impulse of each such contact is given to both bodies as forces, every engine makes the tick,
// and the velocities at its end tell what the impulses still miss. Then the tick is made again from its
// start, with better impulses.
//
// The miss of an impulse is solved for as if the bodies touched nothing else and had no joints (projected
// Gauss-Seidel over the contacts; friction within a cone). They answer less than that where they do, so the
// impulses are extrapolated from those of the passes before (D. Anderson, Iterative procedures for nonlinear
// integral equations, J. ACM 12 (1965)). Both bodies get opposite forces at one point, so momentum is kept.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "server/dynamics/engine.h"

namespace visum::dynamics {

// Steps all engines of a world. The simulation owns it; tick's thread. A step fails where an engine fails.
class Coupling {
 public:
  explicit Coupling(const world::WorldModel& model) : model_(model) {}

  // One tick of all engines, in their order. Fills the forces of all contacts, and keeps the impulses between
  // engines in state.coupling. Warns where they do not agree after kMostPasses. `entering` is told the number
  // of each engine before it steps.
  StepResult step(std::span<const std::unique_ptr<Engine>> engines, const StepInput& input,
                  world::WorldState& state, const std::function<void(std::uint32_t)>& entering = {});

  static constexpr int kMostPasses = 24;

 private:
  // A contact between two engines. Vectors in its frame: along the normal, then along two tangents.
  struct Row {
    std::size_t contact = 0;  // index among the tick's contacts
    std::size_t a = 0, b = 0;
    Eigen::Matrix3d frame;  // columns in W
    Eigen::Vector3d ra, rb;
    Eigen::Matrix3d response;  // of A's velocity against B to an impulse here, if both were free
    double target = 0.0;       // m/s, least velocity along the normal
    double friction = 0.0;
  };
  static constexpr std::size_t kMemory = 6;  // passes that an extrapolation looks back

  void find_rows(std::span<const std::unique_ptr<Engine>> engines, const StepInput& input,
                 const world::WorldState& state);
  Row make_row(std::size_t index, const collision::Contact& contact, const world::WorldState& state,
               double tick_s) const;
  // All engines make the tick from start_, with the impulses p_.
  StepResult pass(std::span<const std::unique_ptr<Engine>> engines, const StepInput& input,
                  world::WorldState& state, const std::function<void(std::uint32_t)>& entering);
  StepResult step_each(std::span<const std::unique_ptr<Engine>> engines, const StepInput& input,
                       world::WorldState& state, const std::function<void(std::uint32_t)>& entering) const;
  // How p_ should change, from the velocities at the end of a pass. Returns the largest change of velocity
  // that this asks for, m/s.
  double find_change(const world::WorldState& state);
  // The next impulses, from those of this pass and of the passes before.
  void extrapolate();
  void hold_in_cones();
  void report(const StepInput& input) const;
  void read(const world::WorldState& state, std::span<const collision::Contact> contacts);
  void write(world::WorldState& state, std::span<const collision::Contact> contacts) const;

  const world::WorldModel& model_;
  std::vector<Row> rows_;
  std::vector<collision::Contact> inner_;  // the contacts within engines
  std::vector<std::size_t> inner_of_;      // their indices among the tick's contacts
  std::vector<Wrench> wrenches_;
  world::WorldState start_;
  Eigen::VectorXd p_, change_, best_, best_change_;  // N·s, three numbers for each row
  Eigen::VectorXd missed_, best_missed_;             // m/s, likewise: what the change would do
  std::vector<Eigen::Vector3d> dv_, dw_;             // by body: what the change does, if all were free
  std::vector<Eigen::Matrix3d> inverse_inertia_;
  // The last passes: where they led without an extrapolation, and what they missed.
  std::array<Eigen::VectorXd, kMemory> past_next_, past_missed_;
  Eigen::Index known_ = 0;  // passes since the last beginning
};

}  // namespace visum::dynamics
