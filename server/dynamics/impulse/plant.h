// The plant of one engine: the bodies, joint axes, springs and contacts that the engine moves, and everything
// that acts on them during a tick. The functions below prepare and measure it; Stepper (stepper.h) moves it.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/dynamics/engine.h"
#include "server/dynamics/impulse/island_pool.h"
#include "server/dynamics/impulse/islands.h"
#include "server/dynamics/impulse/mechanism.h"
#include "server/dynamics/impulse/work_budget.h"

namespace visum::dynamics::impulse {

// A step finds impulses for three moments: for hits (at t), for the look-ahead (at t), and for the velocities
// at t+h. Arrays of impulses are indexed by the moment.
enum Moment : std::size_t { kHit, kAhead, kAfter, kMoments };

// One driven coordinate of a joint, during one tick: drives, friction, damping and stops act on it. Positions
// are in rad or m, velocities in rad/s or m/s, efforts in N·m or N, impulses in N·m·s or N·s.
struct Axis {
  const world::Joint* model = nullptr;
  world::JointId joint;
  std::size_t mechanism = 0;  // index into Plant::mechanisms
  int node = -1;              // of the mechanism's tree; -1: the joint closes a loop
  int loop = -1;              // number of the loop; -1: the joint is in the tree
  // Its joint: the spec, the pose at t, the pose that the look-ahead has reached, the two bodies, and whether
  // the coordinate is an angle.
  const JointSpec* spec = nullptr;
  const JointPose *pose = nullptr, *ahead = nullptr;
  int a = -1, b = -1;
  bool turns = false;
  bool is_free = false;  // the model gives it no stops, friction, damping or spring
  bool idle = false;     // in this tick: is_free, and its drive gives nothing

  // The drive's law (hwparts/joint.h). Without a drive, as `driven` says, the model's dry friction takes its
  // place: a law whose target velocity is 0.
  bool acts = false, driven = false;
  double target = 0.0, compliance_s = 0.0, most = 0.0;  // rad/s, (rad/s)/(N·m), N·m
  double feedforward = 0.0;
  double damping = 0.0;
  // How the law takes part in this step. Within its limit it is part of the tree. At its limit (at_limit is
  // -1 or +1, the sign) it is a known impulse, as long as it stays there. Where neither holds, it is a row
  // with bounds (boxed).
  int at_limit = 0;
  bool boxed = false;
  double expected = 0.0;  // N·m, effort of the law in the last tick: a row starts from it

  // A spring about or along this very axis (springs.cc): its place in Plant::springs. As long as nothing but
  // damping acts beside it, it is sprung: the spring is part of the tree in the look-ahead.
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t spring = kNone;
  bool sprung = false;
  double repeated = 0.0;  // N·m·s, of the spring: its impulse of the look-ahead, which comes again at t+h

  double start = 0.0, rate = 0.0;  // at t
  double mean_rate = 0.0;          // mean velocity over the last look-ahead
  double bias = 0.0;               // mean_rate minus the velocity that the look-ahead started with
  std::array<bool, 2> hits{};      // by lower and upper stop: is hit hard enough to bounce
  std::array<double, kMoments> law{}, damped{};           // N·m·s
  std::array<std::array<double, kMoments>, 2> stopped{};  // impulses of the lower and the upper stop
  // By stop, from the last tick: impulse of the look-ahead, and by how much the end of the step gave more.
  struct KeptStop {
    double impulse = 0.0, change = 0.0;
  };
  std::array<KeptStop, 2> kept_stops{};
  double total = 0.0;  // impulse of drive, friction and damping in this tick
};

// A view of the axes with the given numbers, for range-based loops.
struct AxesOf {
  struct Iterator {
    Axis* axes;
    const std::size_t* number;
    Axis& operator*() const { return axes[*number]; }
    Iterator& operator++() {
      ++number;
      return *this;
    }
    bool operator==(const Iterator&) const = default;
  };
  Iterator begin() const { return {axes, numbers.data()}; }
  Iterator end() const { return {axes, numbers.data() + numbers.size()}; }

  Axis* axes;
  std::span<const std::size_t> numbers;
};

// A contact as far as it is known before its island is: its place in the tick's list, the numbers of its
// bodies (-1: this engine does not move it), whether it keeps the impulses that the last awake tick recorded,
// which record the warm start has of it, and whether it stands: the rest of the touch means nothing then
// (standing.h).
struct TouchEnds {
  static constexpr std::size_t kNew = static_cast<std::size_t>(-1);  // there is no record

  std::size_t contact = 0, record = kNew;
  int a = -1, b = -1;
  bool asleep = false, stands = false;
};

// One contact during one tick. The columns of `frame` are the normal n and the tangents t1, t2, in W.
struct Touch : TouchEnds {
  Touch() {}  // members without a value below stay unset
  explicit Touch(const TouchEnds& ends) : TouchEnds(ends) {}

  Vector3d ra, rb;  // contact point seen from the centres of mass (unused where the number is -1)
  // True if one of the two shapes is a ball whose centre is not its body's centre of mass. The way from the
  // latter to the former is a part of the lever that turns with the body: in the body's axes, and now in W.
  bool eccentric = false;
  Vector3d centre_a, centre_b, centre_a_W, centre_b_W;
  Matrix3d frame;
  Vector3d foreign;       // m/s, the part of A's velocity against B that bodies which others move cause
  Vector3d foreign_turn;  // rad/s, the same for the angular velocity
  bool hits = false;      // hard enough to bounce
  double bounce = 0.0;    // m/s, velocity along the normal after a hit (Newton's law)
  double returned = 0.0;  // restitution as a share of the impulse that stops them (Poisson's law)
  Vector3d bias;          // m/s², relative acceleration of A against B in free flight
  Vector3d turn;          // rad/s, angular velocity with which the contact's frame turns
  bool yields = false;    // one of the two bodies moves by another engine
  bool foreseen = false;  // there is a gap yet, so it takes part in the look-ahead alone
  bool frozen = false;    // its island stood still in this step, with the impulses of the last tick
  int still = 0;          // for how many steps next to nothing has moved in its island; up to kStillSteps
  bool wedged = false;    // in this step: it yields, since nothing that the joints allow opens it
  double depth = 0.0, friction = 0.0, restitution = 0.0;
  double landed = 0.0;  // m, of the depth: left alone, since the bodies have landed so (note_landings())
  double rolling_friction = 0.0, torsional_friction = 0.0;
  std::array<Vector3d, kMoments> impulse;  // in the frame, N·s
  std::array<Vector3d, kMoments> twist;    // of rolling and torsional friction, in the frame, N·m·s
  double total_normal = 0.0;
  Vector3d total = Vector3d::Zero();        // impulse on A in this tick, in W
  Vector3d total_twist = Vector3d::Zero();  // the same for the twist
  Vector3d kept_impulse, kept_twist;        // on A, in W, of one half of a tick
  Vector3d kept_change;  // on A, in W: by how much the end of the last step gave more than its look-ahead
  // In the last tick this contact's island needed no change of its impulses, or stood still. Nothing: the
  // contact is new.
  std::optional<bool> rested;
  int was_still = 0;  // `still`, of the last tick
};

// Velocity of a body that stands after the look-ahead, m/s: it is thrown up by as much as it falls in flight.
inline Vector3d thrown_up(const Vector3d& gravity, double h) {
  return -0.5 * h * gravity;
}

// Overlap that is left alone, m. A contact at rest then exists in every tick.
inline constexpr double kSurfaceLayerM = 5e-7;

// An island must be still for so many steps to be frozen. The first of them may have stopped it, with forces
// that it does not need to stand.
inline constexpr int kStillSteps = 2;

// The landings of note_landings(): the deepest that is left alone in coarse ticks, the time constant of the
// rise from it, and the least that it rises in a tick.
inline constexpr double kDeepestLandingM = 1e-4, kRiseS = 0.5, kSmallestRiseM = 1e-9;

// True if rolling or torsional friction acts at this contact.
inline bool is_held_from_turning(const Touch& touch) {
  return touch.rolling_friction > 0.0 || touch.torsional_friction > 0.0;
}

// The look-ahead starts from the impulses of the last tick.
inline void start_ahead(Touch& touch) {
  if (is_held_from_turning(touch)) touch.twist[kAhead] = touch.frame.transpose() * touch.kept_twist;
  touch.impulse[kAhead] = touch.frame.transpose() * touch.kept_impulse;
  // The surface may have turned since: a normal impulse never pulls.
  touch.impulse[kAhead][0] = std::max(0.0, touch.impulse[kAhead][0]);
}

// The end of the step starts from what was given at t, and what was added to that in the last step.
inline void start_after(Touch& touch) {
  if (touch.foreseen) return;
  touch.impulse[kAfter] = touch.impulse[kAhead] + touch.frame.transpose() * touch.kept_change;
  touch.impulse[kAfter][0] = std::max(touch.impulse[kAfter][0], -touch.impulse[kAhead][0]);
  touch.twist[kAfter] = touch.twist[kAhead];
}

// Directions of a spring's force on B: (w, v) is a unit torque or a unit force in W, and pa, pb are the
// points of the two bodies on which it acts.
struct Pull {
  Vector3d w = Vector3d::Zero(), v = Vector3d::Zero(), pa = Vector3d::Zero(), pb = Vector3d::Zero();
};

// A spring with a damper between two points, or about an axis (springs.cc).
struct Spring {
  JointSpec spec;
  bool acts = false;
  Pull pull;
  double length = 0.0;     // at t: m, or rad for a torsion spring
  double mean_rate = 0.0;  // of the length over the look-ahead
  double impulse = 0.0;    // of the look-ahead; the end of the step repeats it
  double total = 0.0;
  // A spring about a hinge's axis, or along a slider's, knows the axis' place in Plant::axes, and what the
  // axis' position says of its length: sense * position + offset and whole turns, or for a slider
  // sense * (position + offset).
  std::size_t axis = Axis::kNone;
  double sense = 1.0, offset = 0.0;

  // N·s/m or N·m·s/rad: how strongly it answers the mean rate of a step.
  double grip(double h) const { return 0.5 * h * spec.model->stiffness + spec.model->damping; }
};

// Where a body belongs: to a mechanism (and its node there), or to none.
struct Place {
  int mechanism = -1;  // -1: the body is jointed to nothing
  int node = -1;
};

// Everything that one engine moves. ImpulseEngine owns it and uses it on the tick's thread. While the
// islands' steps run side by side (stepper.h), each thread writes nothing but its island: bodies, mechanisms
// with their axes and marks, springs and touches. The lists themselves, the islands, `acting` and what sleeps
// do not change then. The constructor builds it from the model; after that only the members' values change.
// Input is checked before it comes here (step_input.h), so nothing here fails.
struct Plant {
  Plant(const world::WorldModel& world_model, std::int32_t engine_index);

  const world::WorldModel& model;
  const world::EngineSetting& setting;
  Bodies bodies;
  std::vector<Mechanism> mechanisms;
  std::vector<Place> places;            // by body
  std::vector<BodyBlock> free_blocks;   // of the bodies without joints
  std::vector<Axis> axes;               // sorted by mechanism
  std::vector<std::size_t> first_axis;  // by mechanism: its first axis; one entry beyond the last
  // The axes of this tick that are not idle and whose mechanism is awake, and the ranges of each mechanism in
  // that list.
  std::vector<std::size_t> acting, first_acting;
  bool all_idle = false;  // every axis was idle in the last tick
  std::vector<Spring> springs;
  std::vector<Touch> touches;
  Islands islands;  // of this tick
  WorkBudget work;  // of this tick
  IslandPool pool;
  std::vector<char> asleep, mechanism_asleep;  // by body, by mechanism (sleep.h)
  std::vector<char> mechanism_bound;           // by mechanism: rows act on it at this moment (bounded.h)

  AxesOf acting_axes() { return {axes.data(), acting}; }
  AxesOf acting_axes_of(std::size_t mechanism) {
    const std::size_t first = first_acting[mechanism];
    return {axes.data(), std::span(acting).subspan(first, first_acting[mechanism + 1] - first)};
  }
  // Calls act(axis) for each axis of an island that is not idle.
  template <typename Act>
  void for_axes(std::size_t island, Act act) {
    for (const std::size_t m : islands.mechanisms(island))
      for (Axis& axis : acting_axes_of(m)) act(axis);
  }
  // Calls act(touch) for each contact of an island.
  template <typename Act>
  void for_touches(std::size_t island, Act act) {
    for (const std::size_t i : islands.touches(island)) act(touches[i]);
  }
  // Calls `act` with the blocks of all bodies that have no joints and do not sleep.
  template <typename Act>
  void for_free(Act act) const {
    if (setting.sleep_s == 0.0) return act(std::span<const BodyBlock>(free_blocks));
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (places[i].mechanism < 0 && !asleep[i]) act(bodies.block_of(i));
  }
  // True if a spring of the island is a row; the others are laws of axes.
  bool has_loose_springs(std::size_t island) const {
    return std::ranges::any_of(islands.springs(island),
                               [this](std::size_t i) { return is_loose(springs[i]); });
  }
  bool is_loose(const Spring& spring) const {
    return spring.axis == Axis::kNone || !axes[spring.axis].sprung;
  }
  double rate(const Axis& axis) const;  // rad/s or m/s, from the bodies' present velocities
  Vector3d parting(const Axis& axis) const;
};

// Velocity of B against A at the joint's point, m/s.
inline Vector3d Plant::parting(const Axis& axis) const {
  const auto at = [&](int number) -> Vector3d {
    const auto i = static_cast<std::size_t>(number);
    return bodies.v[i] + bodies.w[i].cross(axis.pose->pb - bodies.x[i]);
  };
  return axis.a < 0 ? at(axis.b) : at(axis.b) - at(axis.a);
}

inline double Plant::rate(const Axis& axis) const {
  const Vector3d& along = axis.pose->a;
  if (!axis.turns) return along.dot(parting(axis));
  const Vector3d& w = bodies.w[static_cast<std::size_t>(axis.b)];
  return axis.a < 0 ? along.dot(w) : along.dot(w - bodies.w[static_cast<std::size_t>(axis.a)]);
}

// Distance of an axis at t from its lower (0) or upper (1) stop, rad or m; negative beyond the stop.
inline double room(const Axis& axis, std::size_t side) {
  return side == 0 ? axis.start - axis.model->lower : axis.model->upper - axis.start;
}
// A stop takes part in a step only if the axis could reach it within two steps at its present velocity, plus
// this distance (rad, m).
inline constexpr double kStopReach = 1e-3;
inline bool is_within_reach(const Axis& axis, std::size_t side, double h) {
  return axis.model->limited && room(axis, side) <= 2.0 * h * std::abs(axis.rate) + kStopReach;
}
inline bool is_within_reach(const Axis& axis, double h) {
  return is_within_reach(axis, 0, h) || is_within_reach(axis, 1, h);
}

// Takes the tick's laws from the drives or from the model, reads where the axes are, and lists those that are
// not idle. The members of idle axes are not kept up to date.
void prepare_axes(Plant& plant, std::span<const hwparts::JointDrive> drives, const world::WorldState& state);
// Measures positions and velocities of the axes again, after the bodies have moved by a step of length h
// within the tick.
void measure_axes(Plant& plant, double h);
// Measures the mean velocity to where the look-ahead over h leads: of one axis, or of all axes of a mechanism
// (whose poses ahead are then known). `bias` is set too; for a whole mechanism only where rows act on it.
void measure_ahead(const Plant& plant, Axis& axis, const JointPose& ahead, double h);
void measure_ahead(Plant& plant, std::size_t mechanism, double h);

// A law within its limit is part of the system that is solved for the joints: its axis gives way by the
// compliance k for each N·m·s and is asked for the rate that is missing. The impulses that come out are added
// up by moment. A law at its limit gives known_impulse() instead, together with the feedforward.
inline bool law_in_tree(const Axis& axis) {
  return axis.acts && !axis.boxed && axis.at_limit == 0;
}
inline bool damping_in_tree(const Axis& axis) {
  return axis.damping > 0.0 && !law_in_tree(axis) && axis.node >= 0;
}
inline bool spring_in_tree(const Axis& axis, Moment moment) {
  return axis.sprung && moment == kAhead;
}
inline bool is_in_tree(const Axis& axis, Moment moment) {
  return axis.node >= 0 && (law_in_tree(axis) || damping_in_tree(axis) || spring_in_tree(axis, moment));
}
// The compliance k = c/h of the law, or of damping and spring together, in (rad/s)/(N·m·s).
inline double law_compliance(const Plant& plant, const Axis& axis, Moment moment, double h) {
  if (law_in_tree(axis)) return axis.compliance_s / h;
  const double damping = axis.damping * h;
  return 1.0 /
         (spring_in_tree(axis, moment) ? damping + 0.5 * h * plant.springs[axis.spring].grip(h) : damping);
}
// Rate that the law or the damping still misses at this moment, rad/s or m/s; see axes.cc.
double missing_rate(const Plant& plant, const Axis& axis, Moment moment, double h);
inline void take_law_impulse(Axis& axis, Moment moment, double impulse) {
  (law_in_tree(axis) ? axis.law : axis.damped)[moment] += impulse;
}
// Impulse of a law that is at its limit, for this moment. It is 0 in the instant of a hit.
inline double limit_impulse(const Axis& axis, Moment moment, double h) {
  if (axis.at_limit == 0 || moment == kHit) return 0.0;
  const double most = axis.at_limit * h * axis.most;
  return moment == kAhead ? 0.5 * most : most - axis.law[kHit] - axis.law[kAhead];
}
// Limit impulse, plus this moment's half of the feedforward, plus what a spring repeats.
inline double known_impulse(const Axis& axis, Moment moment, double h) {
  const double known = 0.5 * h * axis.feedforward + limit_impulse(axis, moment, h);
  return moment == kAfter ? known + axis.repeated : known;
}

// Tells an island's trees which axes have a law in the tree at this moment, and how far each gives way.
void set_tree_axes(Plant& plant, std::size_t island, Moment moment, double h);
// Asks the tree for the rates that the laws miss. Returns the largest of them.
double ask_axes(Plant& plant, std::size_t mechanism, Moment moment, double h);
// Adds the tree's answer to the impulses of the laws.
void take_axis_impulses(Plant& plant, std::size_t mechanism, Moment moment);
// Sets the impulses of laws, stops and hits to zero: an island's step starts, or starts again.
void reset_impulses(Plant& plant, std::size_t island);
// An upper bound of the work of an axis' drive in this step, J: what it gives, times the fastest motion along
// it. `speed_before`, rad/s or m/s: at t. A law that asks for rest, as friction does, gives nothing.
double most_work_of_drive(const Plant& plant, const Axis& axis, double speed_before, double h);
// Notes the impulses of an island's laws that are at their limit. Then checks each law: one that has passed
// its limit, or that asks for less than its limit, takes part in another way from now on. Returns true if any
// did, and the moment must then be solved again. With `as_rows` such a law becomes a row, which finds its
// side of the limit itself.
bool change_laws(Plant& plant, std::size_t island, Moment moment, double h, bool as_rows);

bool is_asleep(const Plant& plant, const Spring& spring);
// Measures an island's springs: lengths at t and the directions in which they pull.
void measure_springs(Plant& plant, std::size_t island, const world::WorldState& state);
// Measures the rates of the lengths over the look-ahead of h.
void measure_springs_ahead(Plant& plant, std::size_t island, const world::WorldState& state, double h);
// Repeats the look-ahead's impulses at t+h, after a step of h. Springs that are laws of axes have theirs
// added to what the axes know.
void push_by_springs(Plant& plant, std::size_t island, const world::WorldState& state, double h);

// Marks an island's contacts and stops that are hit hard enough to bounce. Returns true if there are any.
bool find_hits(Plant& plant, std::size_t island, double h);
// Moves each contact of an island to one common point at t+h. The two bodies have slid past each other by
// then, and impulses at two different points would add angular momentum. The point of the body that turns
// faster is taken: the lever of a rolling ball then stays as it is.
void meet_touches(Plant& plant, std::size_t island);
// Moves the depths, levers and frames of an island's contacts on by a step of length h.
void carry_touches(Plant& plant, std::size_t island, double h);
// Velocity of A against B along the normal, m/s; positive: they part.
double normal_speed(const Plant& plant, const Touch& touch);

// Notes how deep each pair of shapes of an island has landed: a body falls into another one before it is seen
// to touch, by up to its speed times h. Lifting it out at once would give a rocking tower more energy than
// landings take, and it would rock for ever. So up to g h² of that depth is left alone, and taken out with
// the time constant kRiseS.
void note_landings(Plant& plant, std::size_t island, std::span<const collision::Contact> contacts, double h);
// Lists the touches of this tick: the contacts that concern this engine's bodies. Only their ends are set.
void list_touches(Plant& plant, std::span<const collision::Contact> contacts);
// Makes a touch from its ends and its contact.
void load_touch(const Plant& plant, std::span<const collision::Contact> contacts,
                const world::WorldState& state, Touch& touch);

}  // namespace visum::dynamics::impulse
