// The laws of drives, friction and damping on the joints' axes: hwparts/joint.h written in impulses.
//
// clang-format off
// Symbols:
//   h      step                                  q, q'      position and velocity at t
//   q'+    velocity at t+h                       q~         mean velocity of the look-ahead
//   v*     the law's target                      c, k       its compliance, and k = c/h
//   most   its largest effort                    s          sign of the limit that it is at, -1 or 1
//   L0, L1, L2                                   impulses of the law: for hits, at t, at t+h
//
//   the law           L0 + L1 + L2 = h clamp((v* - q'+)/c, -most, most)                    (hwparts/joint.h)
//   for hits          |L0| <= h most. In the tree the law answers what the hit changes; a law that passes its
//                     limit there is a row for the whole tick
//   at t              half of it, with q'+ foreseen as 2 q~ - q':
//                     q~ + k (L1 + L0/2) = (v* + q')/2,  |L1| <= h most/2
//   at t+h            the rest:
//                     q'+ + k (L0 + L1 + L2) = v*,  |L0 + L1 + L2| <= h most
//   at the limit      L1 = s h most/2 and L0 + L1 + L2 = s h most, as long as s times the missing rate is
//                     not below 0. Examples: a backlash that is crossed, a motor that gives all it can
//   damping d         the law with v* = 0, c = 1/d, without a limit
//   dry friction      the law with v* = 0, c = 0, most = friction
//   a geared rotor    the law with k near 1/J and v* its own speed (hwparts/drive/gear.h). q~ comes from
//                     the look-ahead, so the rotor feels how the axis' speed changes in free flight
//
// Sources: half of the law at t and the rest at t+h, as forces in RATTLE (Andersen, J. Comput. Phys. 52,
// 1983); a compliance on the diagonal, as CFM in Hsu, Peters, Extending Open Dynamics Engine for the DARPA
// Virtual Robotics Challenge, SIMPAR 2014; the rotor as a coordinate that is geared to the axis and answers
// with it, as gears in Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 9.
// clang-format on
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/plant.h"
#include "server/world/joint_kinds.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kMostCompliance =
    1e30;  // (rad/s)/(N·m): gives way to everything, and still fits a single-precision number
constexpr double kAtLimit = 1.0 - 1e-9;  // share of the limit: a law that gave this much starts at its limit
constexpr double kMoves = 1e-9;          // rad/s, m/s: above this speed dry friction starts at its limit
constexpr double kNearNoLengthM = 1e-3;  // of a spring along a slider
constexpr double kPassed = 1e-12;        // share of the limit by which rounding may pass it

// True if the drive gives no effort at all.
bool says_nothing(const hwparts::JointDrive& drive) {
  return drive.max_effort == 0.0 && drive.feedforward == 0.0;
}

// Decides how the law starts the tick: within its limit, at its limit (by the last effort, or for friction by
// the direction of motion), or as a row. A law is a row if its joint closes a loop. With the iterative solver
// (`as_row`) a law at its limit is a row, too.
void take_limit(Axis& axis, bool as_row) {
  double side = std::abs(axis.expected) >= kAtLimit * axis.most ? axis.expected : 0.0;
  if (!axis.driven && std::abs(axis.rate) > kMoves) side = -axis.rate;
  axis.boxed = axis.acts && (axis.loop >= 0 || (as_row && side != 0.0));
  axis.at_limit = axis.acts && !axis.boxed ? (side > 0.0) - (side < 0.0) : 0;
}

// Sets the axis' law from the drive, or from the model's friction and damping where the drive gives nothing.
void take_law(Axis& axis, const hwparts::JointDrive& drive, double last_effort, bool as_row) {
  const bool driven = axis.driven = !says_nothing(drive);
  axis.target = driven ? drive.target_velocity : 0.0;
  // Rounded to single precision. A compliance that changes by less from tick to tick (a winding that warms
  // up) then leaves the tree's factors valid.
  axis.compliance_s =
      driven ? static_cast<double>(static_cast<float>(std::min(drive.compliance, kMostCompliance))) : 0.0;
  axis.most = driven ? drive.max_effort : axis.model->friction;
  axis.feedforward = drive.feedforward;
  axis.damping = driven ? 0.0 : axis.model->damping;
  axis.acts = axis.most > 0.0;
  axis.expected = std::clamp(last_effort - axis.feedforward, -axis.most, axis.most);
  take_limit(axis, as_row);
}

// Reads where the axis is at t, and its law.
void take_axis(Axis& axis, const hwparts::JointDrive& drive, const world::JointState& joint, bool as_row) {
  axis.start = joint.position;
  axis.rate = joint.velocity;
  axis.total = 0.0;
  axis.kept_stops = {};
  take_law(axis, drive, joint.effort, as_row);
}

// True if the spring of a slider may pass its point of no length in this tick, where its force turns around.
bool may_turn_around(const Plant& plant, const Axis& axis) {
  constexpr double kMostSteps = 4.0;  // of the tick: as far as the steps of higher orders go to and fro
  const Spring& spring = plant.springs[axis.spring];
  if (axis.turns || spring.spec.model->rest == 0.0) return false;
  const double way = 1e-9 * static_cast<double>(plant.model.tick_ns) * std::abs(axis.rate);
  return std::abs(axis.start + spring.offset) <= kMostSteps * way + kNearNoLengthM;
}

// Position of the axis in a pose; an angle is unwrapped to the turn that is nearest to `near`.
double position(const Axis& axis, const JointPose& pose, double near) {
  return axis.turns ? joint_angle(*axis.spec, pose, near) : pose.a.dot(pose.pb - pose.pa);
}

// Mean velocity from t to the pose ahead, h later.
double mean_rate(const Axis& axis, const JointPose& ahead, double h) {
  return (position(axis, ahead, axis.start + h * axis.rate) - axis.start) / h;
}

// Rate that a law still misses: its target velocity is `target`, it has given the impulses `done`, and it
// gives way by k for each N·m·s.
inline double missing(const Plant& plant, const Axis& axis, Moment moment, double target, double k,
                      const std::array<double, kMoments>& done) {
  if (moment == kAhead)
    return 0.5 * (target + axis.rate) - axis.mean_rate - k * (done[kAhead] + 0.5 * done[kHit]);
  return target - plant.rate(axis) - k * (done[kHit] + done[kAhead] + done[kAfter]);
}

inline double missing_of_law(const Plant& plant, const Axis& axis, Moment moment, double h) {
  return missing(plant, axis, moment, axis.target, axis.compliance_s / h, axis.law);
}

// The limit that the law's impulse has passed: -1, 1, or 0 for none.
int passed_limit(const Axis& axis, Moment moment, double h) {
  const double given =
      moment == kAhead ? axis.law[kAhead] : axis.law[kHit] + axis.law[kAhead] + axis.law[kAfter];
  const double most = (moment == kAhead ? 0.5 : 1.0) * h * axis.most * (1.0 + kPassed);
  return (given > most) - (given < -most);
}

// True if the law may go on taking part as it does now.
bool suits(const Plant& plant, const Axis& axis, Moment moment, double h) {
  if (axis.at_limit != 0)
    return moment == kHit || axis.at_limit * missing_of_law(plant, axis, moment, h) >= 0.0;
  return !law_in_tree(axis) || passed_limit(axis, moment, h) == 0;
}

// The same of a sprung axis in the look-ahead. Two laws on one axis are one law: what either gives at the
// same rate is added up, also in `damped`.
double missing_of_spring(const Plant& plant, const Axis& axis, double h) {
  const Spring& spring = plant.springs[axis.spring];
  const world::Joint& model = *spring.spec.model;
  const double k = law_compliance(plant, axis, kAhead, h);
  const double pull = -0.5 * h * spring.sense * model.stiffness * (spring.length - model.rest);
  return k * (pull + 0.5 * h * axis.damping * axis.rate) - axis.mean_rate -
         k * (axis.damped[kAhead] + 0.5 * axis.damped[kHit]);
}

// Rate that is asked of the tree: the law's, or that of damping and spring where no law is in the tree.
inline double missing_in_tree(const Plant& plant, const Axis& axis, Moment moment, double h) {
  if (spring_in_tree(axis, moment)) return missing_of_spring(plant, axis, h);
  if (damping_in_tree(axis))
    return missing(plant, axis, moment, 0.0, law_compliance(plant, axis, moment, h), axis.damped);
  return missing_of_law(plant, axis, moment, h);
}

}  // namespace

double missing_rate(const Plant& plant, const Axis& axis, Moment moment, double h) {
  return missing_in_tree(plant, axis, moment, h);
}

void prepare_axes(Plant& plant, std::span<const hwparts::JointDrive> drives, const world::WorldState& state) {
  // Nothing to do where every axis was idle in the last tick and no drive gives anything now.
  if (plant.all_idle && std::ranges::all_of(drives, says_nothing)) return;
  const bool as_row = plant.setting.solver == "iterate";
  plant.all_idle = true;
  plant.acting.clear();
  for (std::size_t m = 0; m < plant.mechanisms.size(); ++m) {
    plant.first_acting[m] = plant.acting.size();
    for (std::size_t i = plant.first_axis[m]; i < plant.first_axis[m + 1]; ++i) {
      Axis& axis = plant.axes[i];
      const hwparts::JointDrive& drive = drives[axis.joint.index()];
      const bool was_idle = axis.idle;
      // An axis that stays idle is not read at all. One that has just become idle is read once more and taken
      // out of the tree.
      axis.idle = axis.is_free && says_nothing(drive);
      plant.all_idle = plant.all_idle && axis.idle;
      if (axis.idle && was_idle) continue;
      take_axis(axis, drive, state.joints[axis.joint.index()], as_row);
      axis.sprung = axis.spring != Axis::kNone && !axis.acts && !may_turn_around(plant, axis);
      if (!axis.idle && !plant.mechanism_asleep[m]) plant.acting.push_back(i);
      if (axis.idle && axis.node >= 0) plant.mechanisms[m].set_axis(static_cast<std::size_t>(axis.node), {});
    }
  }
  plant.first_acting.back() = plant.acting.size();
}

void measure_axes(Plant& plant, double h) {
  for (Axis& axis : plant.acting_axes()) {
    const double last = axis.rate;
    axis.rate = plant.rate(axis);
    // The angle is unwrapped to the turn that the mean of old and new velocity predicts.
    const double expected = axis.start + 0.5 * h * (last + axis.rate);
    axis.start = position(axis, pose_now(*axis.spec, plant.bodies, axis.start), expected);
  }
}

void measure_ahead(const Plant& plant, Axis& axis, const JointPose& ahead, double h) {
  axis.mean_rate = mean_rate(axis, ahead, h);
  axis.bias = axis.mean_rate - plant.rate(axis);
}

void measure_ahead(Plant& plant, std::size_t mechanism, double h) {
  const bool bound = plant.mechanism_bound[mechanism] != 0;
  for (Axis& axis : plant.acting_axes_of(mechanism)) {
    // Without law, damping, spring or stops nothing needs the mean velocity.
    if (!axis.acts && axis.damping == 0.0 && !axis.sprung && !axis.model->limited) continue;
    if (bound)
      measure_ahead(plant, axis, *axis.ahead, h);
    else
      axis.mean_rate = mean_rate(axis, *axis.ahead, h);
  }
}

void set_tree_axes(Plant& plant, std::size_t island, Moment moment, double h) {
  plant.for_axes(island, [&](const Axis& axis) {
    if (axis.node < 0) return;
    const bool implicit = is_in_tree(axis, moment);
    plant.mechanisms[axis.mechanism].set_axis(
        static_cast<std::size_t>(axis.node),
        {implicit, implicit ? law_compliance(plant, axis, moment, h) : 0.0});
  });
}

double ask_axes(Plant& plant, std::size_t mechanism, Moment moment, double h) {
  double largest = 0.0;
  Tree& tree = plant.mechanisms[mechanism].tree();
  for (const Axis& axis : plant.acting_axes_of(mechanism)) {
    if (!is_in_tree(axis, moment)) continue;
    const double missing = missing_in_tree(plant, axis, moment, h);
    tree.ask_axis(static_cast<std::size_t>(axis.node), missing);
    // Keeps a NaN as the largest.
    if (!(std::abs(missing) <= largest) && !std::isnan(largest)) largest = std::abs(missing);
  }
  return largest;
}

void take_axis_impulses(Plant& plant, std::size_t mechanism, Moment moment) {
  const Tree& tree = plant.mechanisms[mechanism].tree();
  for (Axis& axis : plant.acting_axes_of(mechanism))
    if (is_in_tree(axis, moment))
      take_law_impulse(axis, moment, tree.axis_impulse(static_cast<std::size_t>(axis.node)));
}

void reset_impulses(Plant& plant, std::size_t island) {
  plant.for_axes(island, [](Axis& axis) {
    axis.law = {};
    axis.damped = {};
    axis.stopped = {};
    axis.repeated = 0.0;
  });
  plant.for_touches(island, [](Touch& touch) { touch.impulse[kHit] = touch.twist[kHit] = Vector3d::Zero(); });
}

double most_work_of_drive(const Plant& plant, const Axis& axis, double speed_before, double h) {
  double law = 0.0;
  if (axis.target != 0.0)
    for (const double impulse : axis.law) law += std::abs(impulse);
  const double fastest = std::max(speed_before, std::abs(plant.rate(axis)));
  return (law + std::abs(h * axis.feedforward)) * fastest;
}

bool change_laws(Plant& plant, std::size_t island, Moment moment, double h, bool as_rows) {
  bool any = false;
  plant.for_axes(island, [&](Axis& axis) {
    // A law at its limit has given its limit's impulse in this moment.
    if (axis.at_limit != 0) axis.law[moment] = limit_impulse(axis, moment, h);
    if (suits(plant, axis, moment, h)) return;
    // A law that leaves its limit goes back into the tree. One that passes it becomes a known impulse there.
    // With `as_rows` both become rows.
    axis.at_limit = axis.at_limit != 0 || as_rows ? 0 : passed_limit(axis, moment, h);
    axis.boxed = as_rows;
    any = true;
  });
  return any;
}

}  // namespace visum::dynamics::impulse
