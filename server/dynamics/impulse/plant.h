// All that one engine moves, and what acts on it during a tick. Built once; a step writes into it and nowhere
// else.
#pragma once

#include <cmath>

#include "server/dynamics/engine.h"
#include "server/dynamics/impulse/mechanism.h"

namespace visum::dynamics::impulse {

// The times within a step at which impulses are found: when things hit, for the look-ahead, and for the
// velocities at the end.
enum Moment : std::size_t { kHit, kAhead, kAfter, kMoments };

// A joint's axis that drives, friction, damping or stops act on, in one tick.
struct Axis {
  const world::Joint* model = nullptr;
  world::JointId joint;
  std::size_t mechanism = 0;
  int node = -1;  // of the tree; -1: the joint closes a loop
  int loop = -1;
  // Of its joint: what it is, its poses at t and where the look-ahead has led, its bodies, whether it is an
  // angle.
  const JointSpec* spec = nullptr;
  const JointPose *pose = nullptr, *ahead = nullptr;
  int a = -1, b = -1;
  bool turns = false;
  bool is_free = false;  // as the model has it: no stops, friction or damping
  bool idle = false;     // in this tick: is free, and nothing is given to it

  // hwparts/joint.h, or the model's friction as a drive that wants to stand.
  bool acts = false;
  double target = 0.0, compliance_s = 0.0, most = 0.0;  // rad/s, (rad/s)/(N·m), N·m
  double feedforward = 0.0;
  double damping = 0.0;
  // How the law takes part: as long as it is within its limit in the tree; at the limit as an impulse that is
  // known (-1, +1: its sign), where that is seen to go on; as a row where neither does.
  int at_limit = 0;
  bool boxed = false;
  double expected = 0.0;  // N·m, what the law gave in the last tick: where a row starts

  double start = 0.0, rate = 0.0;                // position and velocity at t
  double mean_rate = 0.0;                        // what the last look-ahead gives
  double bias = 0.0;                             // by how much that is not the velocity that it started with
  std::array<bool, 2> hits{};                    // a stop, to bounce off it
  std::array<double, kMoments> law{}, damped{};  // impulses, N·m·s
  std::array<std::array<double, kMoments>, 2> stopped{};  // at the lower and the upper stop
  double total = 0.0;                                     // of drive, friction and damping in this tick
};

// The axes of some numbers, to be gone through.
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

// A contact in one tick. Frame: columns n, t1, t2 in W.
struct Touch {
  Touch() {}  // what has no value below is not set

  std::size_t contact = 0;  // index in the tick's list
  int a = -1, b = -1;       // numbers of bodies; -1: not ours
  Vector3d ra, rb;          // from the centres of mass (-1: unused)
  Matrix3d frame;
  Vector3d foreign;       // velocity of A against B as far as it is not ours
  Vector3d foreign_turn;  // likewise the angular velocity
  double bounce = 0.0;    // velocity along the normal after a hit
  double returned = 0.0;  // share of the impulse that stops them, by Poisson's law
  Vector3d bias;          // relative acceleration in free flight, over the step
  Vector3d turn;          // angular velocity with which the contact turns
  bool yields = false;    // one of the two moves by another engine
  double depth = 0.0, friction = 0.0, restitution = 0.0;
  double rolling_friction = 0.0, torsional_friction = 0.0;
  std::array<Vector3d, kMoments> impulse;  // in the frame
  std::array<Vector3d, kMoments> twist;    // of rolling and torsional friction, in the frame
  double total_normal = 0.0;
  Vector3d total = Vector3d::Zero();        // on A, in W
  Vector3d total_twist = Vector3d::Zero();  // likewise
  bool asleep = false;                // keeps its impulses, those of the record that the last awake tick left
  Vector3d kept_impulse, kept_twist;  // on A, in W
};

inline bool is_held_from_turning(const Touch& touch) {
  return touch.rolling_friction > 0.0 || touch.torsional_friction > 0.0;
}

// A force between two points, or about an axis, along (w, v) at the points pa and pb.
struct Pull {
  Vector3d w, v, pa, pb;
};

struct Spring {
  JointSpec spec;
  bool acts = false;
  Pull pull;
  double length = 0.0;     // or angle, at t
  double mean_rate = 0.0;  // of it, over the look-ahead
  double impulse = 0.0;    // of the look-ahead, repeated at the end
  double total = 0.0;
};

struct Place {
  int mechanism = -1;  // -1: stands free
  int node = -1;
};

struct Plant {
  Plant(const world::WorldModel& world_model, std::int32_t engine_index);

  const world::WorldModel& model;
  const world::EngineSetting& setting;
  Bodies bodies;
  std::vector<Mechanism> mechanisms;
  std::vector<Place> places;            // by body
  std::vector<BodyBlock> free_blocks;   // of bodies that stand free
  std::vector<Axis> axes;               // of one mechanism after the other
  std::vector<std::size_t> first_axis;  // by mechanism, and one beyond
  // Of this tick: the numbers of the axes that are not idle, of mechanisms that are awake; ranges as above.
  std::vector<std::size_t> acting, first_acting;
  bool all_idle = false;  // all axes, in the last tick
  std::vector<Spring> springs;
  std::vector<Touch> touches;
  bool rested = false;  // the contacts' impulses of the last tick were left as they were
  std::vector<char> asleep, mechanism_asleep;  // by body, by mechanism (sleep.h)
  std::vector<char> mechanism_bound;           // of the moment: rows act on it (bounded.h)

  AxesOf acting_axes() { return {axes.data(), acting}; }
  AxesOf acting_axes_of(std::size_t mechanism) {
    const std::size_t first = first_acting[mechanism];
    return {axes.data(), std::span(acting).subspan(first, first_acting[mechanism + 1] - first)};
  }
  // All that stands free and does not sleep, by blocks.
  template <typename Act>
  void for_free(Act act) const {
    if (setting.sleep_s == 0.0) return act(std::span<const BodyBlock>(free_blocks));
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (places[i].mechanism < 0 && !asleep[i]) act(bodies.block_of(i));
  }
  double rate(const Axis& axis) const;  // of the bodies' velocities as they are
  Vector3d parting(const Axis& axis) const;
};

// Velocity of B against A at the joint's point.
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

// How far an axis is from its lower (0) or upper (1) stop, and whether that may act in a step of length h.
inline double room(const Axis& axis, std::size_t side) {
  return side == 0 ? axis.start - axis.model->lower : axis.model->upper - axis.start;
}
// A stop that is farther off than the axis comes in two steps, and this, takes no part: rad, m.
inline constexpr double kStopReach = 1e-3;
inline bool is_within_reach(const Axis& axis, std::size_t side, double h) {
  return axis.model->limited && room(axis, side) <= 2.0 * h * std::abs(axis.rate) + kStopReach;
}
inline bool is_within_reach(const Axis& axis, double h) {
  return is_within_reach(axis, 0, h) || is_within_reach(axis, 1, h);
}

// The tick's laws from drives or the model, where the axes are, and which of them are not idle. Nothing is
// known of the others.
void prepare_axes(Plant& plant, std::span<const hwparts::JointDrive> drives, const world::WorldState& state);
// Where the bodies have been moved within a tick, in a step of length h: positions and velocities of the
// axes.
void measure_axes(Plant& plant, double h);
// Where the look-ahead leads them; of a mechanism, once it is placed there.
// `bias`: for its rows, if it has any.
void measure_ahead(const Plant& plant, Axis& axis, const JointPose& ahead, double h);
void measure_ahead(Plant& plant, std::size_t mechanism, double h);

// A law that is not at its limit takes part where joints are solved for: its axis gives way by k for each
// N·m·s, and misses a rate. Its impulses are counted by moment. A law at its limit gives known_impulse(),
// with what is given beside the law.
inline bool law_in_tree(const Axis& axis) {
  return axis.acts && !axis.boxed && axis.at_limit == 0;
}
inline bool damping_in_tree(const Axis& axis) {
  return axis.damping > 0.0 && !law_in_tree(axis) && axis.node >= 0;
}
inline bool is_in_tree(const Axis& axis) {
  return axis.node >= 0 && (law_in_tree(axis) || damping_in_tree(axis));
}
inline double law_compliance(const Axis& axis, double h) {
  return law_in_tree(axis) ? axis.compliance_s / h : 1.0 / (axis.damping * h);
}
double missing_rate(const Plant& plant, const Axis& axis, Moment moment, double h);
inline void take_law_impulse(Axis& axis, Moment moment, double impulse) {
  (law_in_tree(axis) ? axis.law : axis.damped)[moment] += impulse;
}
// What the law gives at this moment where it is at its limit; nothing in the instant of a hit.
inline double limit_impulse(const Axis& axis, Moment moment, double h) {
  if (axis.at_limit == 0 || moment == kHit) return 0.0;
  const double most = axis.at_limit * h * axis.most;
  return moment == kAhead ? 0.5 * most : most - axis.law[kHit] - axis.law[kAhead];
}
inline double known_impulse(const Axis& axis, Moment moment, double h) {
  return 0.5 * h * axis.feedforward + limit_impulse(axis, moment, h);
}

// Puts those laws into the mechanisms' trees.
void set_tree_axes(Plant& plant, double h);
// Returns the largest rate that is missing.
double ask_axes(Plant& plant, std::size_t mechanism, Moment moment, double h);
void take_axis_impulses(Plant& plant, std::size_t mechanism, Moment moment);
// Forgets the impulses of a step that starts (again).
void reset_impulses(Plant& plant);
// Counts what laws at their limit give. Where a law has passed its limit, or its limit is more than it asks
// for, it takes part otherwise from now on: true, the moment is to be solved again. `as_rows`: what changes
// is a row, which finds out itself.
bool change_laws(Plant& plant, Moment moment, double h, bool as_rows);

bool is_asleep(const Plant& plant, const Spring& spring);
// Where the springs are at t, and what they pull on.
void measure_springs(Plant& plant, const world::WorldState& state);
// Their rates over the look-ahead, where it has led.
void measure_springs_ahead(Plant& plant, const world::WorldState& state, double h);
void push_by_springs(Plant& plant, const world::WorldState& state);  // what the look-ahead found, once more

// Which contacts and stops are hit hard enough to bounce; true if any.
bool find_hits(Plant& plant, double h);
// At t+h the two bodies of a contact have slid past each other. Pushed each at a point of its own they would
// win angular momentum: they meet at the point of that which turns more, as a ball that rolls keeps its
// lever.
void meet_touches(Plant& plant);
// Contacts move on with the bodies that they are of.
void carry_touches(Plant& plant, double h);
double normal_speed(const Plant& plant, const Touch& touch);

void find_touches(Plant& plant, std::span<const collision::Contact> contacts, const world::WorldState& state);

}  // namespace visum::dynamics::impulse
