// The tick's contacts in the form that the solver takes.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "server/dynamics/impulse/joints/directions.h"
#include "server/dynamics/impulse/plant.h"
#include "server/dynamics/impulse/rotation.h"

namespace visum::dynamics::impulse {
namespace {

// Motion at a point of a body that another engine moves: m/s, rad/s.
struct Foreign {
  Vector3d velocity, turn;
};

Foreign foreign_motion(const world::WorldState& state, world::BodyId id, const Vector3d& p) {
  const world::BodyState& body = state.bodies[id.index()];
  return {body.v_WC + body.w_WB.cross(p - body.p_WC), body.w_WB};
}

// A body that hits no faster than it falls in this many steps does not bounce.
constexpr double kFallSteps = 2.0;

// The speed after a hit, m/s, as seen at the depth d at which the contact was found. At the surface it leaves
// with e times the speed that met it: u'^2 = e^2 (u^2 - 2 a d) + 2 a d, with a the acceleration towards the
// surface.
double speed_after_hit(double speed, double restitution, double depth, double acceleration) {
  const double fall = 2.0 * acceleration * std::max(0.0, depth);
  const double at_surface = speed * speed - fall;
  if (at_surface <= 0.0) return 0.0;
  return std::sqrt(std::max(0.0, restitution * restitution * at_surface + fall));
}

// From the centre of mass of one of our bodies to the centre of its ball, in the body's axes; 0 for other
// shapes.
Vector3d centre_of_ball(const Plant& plant, world::ShapeId id, int number) {
  const world::Shape& shape = plant.model.shapes[id.index()];
  if (number < 0 || shape.kind != world::ShapeKind::kSphere) return Vector3d::Zero();
  return shape.X_BS.p - plant.model.bodies[shape.body.index()].p_BC;
}

void find_centres(const Plant& plant, const collision::Contact& contact, Touch& touch) {
  touch.centre_a = centre_of_ball(plant, contact.shape_a, touch.a);
  touch.centre_b = centre_of_ball(plant, contact.shape_b, touch.b);
  touch.eccentric = !touch.centre_a.isZero(0.0) || !touch.centre_b.isZero(0.0);
  touch.centre_a_W = touch.centre_b_W = Vector3d::Zero();
  const std::vector<Quaterniond>& q_WB = plant.bodies.q_WB;
  if (touch.eccentric && touch.a >= 0)
    touch.centre_a_W = q_WB[static_cast<std::size_t>(touch.a)] * touch.centre_a;
  if (touch.eccentric && touch.b >= 0)
    touch.centre_b_W = q_WB[static_cast<std::size_t>(touch.b)] * touch.centre_b;
}

// The part of a lever that turns with a ball's body follows that body.
void follow_centre(const Quaterniond& q_WB, const Vector3d& centre, Vector3d& centre_W, Vector3d& lever) {
  const Vector3d now = q_WB * centre;
  lever += now - centre_W;
  centre_W = now;
}

void follow_centres(const Plant& plant, Touch& touch) {
  const std::vector<Quaterniond>& q_WB = plant.bodies.q_WB;
  if (touch.a >= 0)
    follow_centre(q_WB[static_cast<std::size_t>(touch.a)], touch.centre_a, touch.centre_a_W, touch.ra);
  if (touch.b >= 0)
    follow_centre(q_WB[static_cast<std::size_t>(touch.b)], touch.centre_b, touch.centre_b_W, touch.rb);
}

}  // namespace

double normal_speed(const Plant& plant, const Touch& touch) {
  const Bodies& bodies = plant.bodies;
  Vector3d u = touch.foreign;
  if (touch.a >= 0) {
    const auto a = static_cast<std::size_t>(touch.a);
    u += bodies.v[a] + bodies.w[a].cross(touch.ra);
  }
  if (touch.b >= 0) {
    const auto b = static_cast<std::size_t>(touch.b);
    u -= bodies.v[b] + bodies.w[b].cross(touch.rb);
  }
  return touch.frame.col(0).dot(u);
}

bool find_hits(Plant& plant, std::size_t island, double h) {
  const double slow = kFallSteps * h * plant.model.gravity.norm();
  bool any = false;
  plant.for_touches(island, [&](Touch& touch) {
    touch.hits = false;
    touch.bounce = 0.0;
    touch.returned = touch.restitution;
    if (touch.restitution == 0.0 || touch.foreseen) return;
    const double speed = -normal_speed(plant, touch);
    if (speed <= slow) return;
    touch.bounce =
        speed_after_hit(speed, touch.restitution, touch.depth, -touch.frame.col(0).dot(touch.bias));
    touch.returned = touch.bounce / speed;
    touch.hits = any = true;
  });
  // A stop is hit if the axis reaches it within the step at its present velocity.
  plant.for_axes(island, [&](Axis& axis) {
    if (!axis.model->limited || axis.model->stop_restitution == 0.0) return;
    for (const std::size_t side : {0u, 1u}) {
      const double speed = (side == 0 ? -1.0 : 1.0) * axis.rate;
      axis.hits[side] = speed > slow && room(axis, side) < h * speed;
      any = any || axis.hits[side];
    }
  });
  return any;
}

void meet_touches(Plant& plant, std::size_t island) {
  const Bodies& bodies = plant.bodies;
  plant.for_touches(island, [&](Touch& touch) {
    // A contact that bounces off ends where it was.
    if (touch.eccentric && !touch.hits) follow_centres(plant, touch);
    // A contact with something that does not move, or by another engine, has only one lever.
    if (touch.a < 0 || touch.b < 0) return;
    const auto a = static_cast<std::size_t>(touch.a), b = static_cast<std::size_t>(touch.b);
    const Vector3d apart = bodies.x[b] + touch.rb - bodies.x[a] - touch.ra;
    if (bodies.w[a].squaredNorm() < bodies.w[b].squaredNorm())
      touch.ra += apart;
    else
      touch.rb -= apart;
  });
}

void carry_touches(Plant& plant, std::size_t island, double h) {
  plant.for_touches(island, [&](Touch& touch) {
    // The relative velocity changes the depth, and the contact turns with the slower body.
    touch.depth -= h * normal_speed(plant, touch);
    if (touch.turn.isZero(0.0)) return;
    const Matrix3d R = rotation(h * touch.turn).toRotationMatrix();
    touch.ra = R * (touch.ra - touch.centre_a_W) + touch.centre_a_W;
    touch.rb = R * (touch.rb - touch.centre_b_W) + touch.centre_b_W;
    touch.frame = R * touch.frame;
  });
}

void note_landings(Plant& plant, std::size_t island, std::span<const collision::Contact> contacts, double h) {
  const double deepest = std::min(plant.model.gravity.norm() * h * h, kDeepestLandingM);
  const std::span<const std::size_t> touches = plant.islands.touches(island);
  const auto pair_of = [&](std::size_t i) {
    const collision::Contact& contact = contacts[plant.touches[touches[i]].contact];
    return std::pair(contact.shape_a.value, contact.shape_b.value);
  };
  for (std::size_t first = 0, end = 0; first < touches.size(); first = end) {
    double landed = 0.0;
    for (; end < touches.size() && pair_of(end) == pair_of(first); ++end) {
      const Touch& touch = plant.touches[touches[end]];
      const double risen = std::max(touch.landed * h / kRiseS, kSmallestRiseM);
      const double fallen = std::min(-normal_speed(plant, touch) * h, touch.depth - kSurfaceLayerM);
      landed = std::max({landed, touch.landed - risen, std::min(fallen, deepest)});
    }
    for (std::size_t i = first; i < end; ++i) plant.touches[touches[i]].landed = landed;
  }
}

// Touches that exist already keep the rest of their memory as it is: other threads will write it.
void list_touches(Plant& plant, std::span<const collision::Contact> contacts) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    TouchEnds ends;
    ends.contact = i;
    ends.a = plant.bodies.number(contacts[i].body_a);
    ends.b = plant.bodies.number(contacts[i].body_b);
    // A contact between bodies of other engines is not ours.
    if (ends.a < 0 && ends.b < 0) continue;
    ends.asleep = plant.asleep[static_cast<std::size_t>(std::max(ends.a, ends.b))] != 0;
    if (count == plant.touches.size()) plant.touches.emplace_back();
    static_cast<TouchEnds&>(plant.touches[count++]) = ends;
  }
  plant.touches.resize(count);
}

void load_touch(const Plant& plant, std::span<const collision::Contact> contacts,
                const world::WorldState& state, Touch& touch) {
  const Bodies& bodies = plant.bodies;
  const collision::Contact& contact = contacts[touch.contact];
  std::construct_at(&touch, TouchEnds(touch));
  touch.kept_impulse = touch.kept_twist = touch.kept_change = Vector3d::Zero();
  // The frame: the normal and two tangents.
  const Across tangents = across(contact.normal_W);
  touch.frame.col(0) = contact.normal_W;
  touch.frame.col(1) = tangents.first;
  touch.frame.col(2) = tangents.second;
  touch.foreign = touch.foreign_turn = Vector3d::Zero();
  touch.ra = touch.rb = touch.bias = Vector3d::Zero();
  const Vector3d point_of_b = contact.p_W + contact.to_b_W;
  Vector3d turn_a = Vector3d::Zero(), turn_b = Vector3d::Zero();
  // Each body adds to the free fall, or, not moved by this engine, to the foreign velocity.
  if (touch.a >= 0) {
    const auto a = static_cast<std::size_t>(touch.a);
    touch.ra = contact.p_W - bodies.x[a];
    touch.bias += plant.model.gravity;
    turn_a = bodies.w[a];
  } else if (!plant.model.bodies[contact.body_a.index()].fixed) {
    const Foreign motion = foreign_motion(state, contact.body_a, contact.p_W);
    touch.yields = !plant.model.bodies[contact.body_a.index()].kinematic;
    touch.foreign += motion.velocity;
    touch.foreign_turn += motion.turn;
    turn_a = motion.turn;
  }
  if (touch.b >= 0) {
    const auto b = static_cast<std::size_t>(touch.b);
    touch.rb = point_of_b - bodies.x[b];
    touch.bias -= plant.model.gravity;
    turn_b = bodies.w[b];
  } else if (!plant.model.bodies[contact.body_b.index()].fixed) {
    const Foreign motion = foreign_motion(state, contact.body_b, point_of_b);
    touch.yields = !plant.model.bodies[contact.body_b.index()].kinematic;
    touch.foreign -= motion.velocity;
    touch.foreign_turn -= motion.turn;
    turn_b = motion.turn;
  }
  // The contact turns with the body that turns less: a rolling ball keeps its lever, and a held thing turns
  // with the hand.
  touch.turn = turn_a.squaredNorm() < turn_b.squaredNorm() ? turn_a : turn_b;
  // Two bodies that turn together fly on straight lines until their next impulse. They part at h/2 times
  // this acceleration.
  if (touch.a >= 0 && touch.b >= 0) touch.bias += touch.turn.cross(touch.turn.cross(touch.ra - touch.rb));
  find_centres(plant, contact, touch);
  touch.depth = contact.depth;
  touch.foreseen = contact.depth < 0.0;
  touch.friction = contact.friction;
  touch.restitution = contact.restitution;
  touch.rolling_friction = contact.rolling_friction;
  touch.torsional_friction = contact.torsional_friction;
  for (std::size_t k = 0; k < kMoments; ++k) touch.impulse[k] = touch.twist[k] = Vector3d::Zero();
}

}  // namespace visum::dynamics::impulse
