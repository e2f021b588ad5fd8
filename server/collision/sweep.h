// Continuous collision: keeps fast bodies from passing through others between two ticks. Contacts are found
// where bodies are when a tick begins. A body that moves by more than its own thickness within a tick can be
// in front of a plate at one tick and behind it at the next. The way of such a body is searched for the
// place where it first touches something, and there it is left. It keeps its velocity, and the next tick
// finds the contact.
//
// Only free bodies are held back, which no joint holds: a linked one cannot be moved alone. For linked ones
// the search tells what they would pass through, and where they first touch it. The caller turns that into
// contacts and makes the step again (CollisionStage::foresee()).
//
// Two meshes are not searched. Planes need no search, since nothing gets behind a plane. The search is
// conservative advancement: B. Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems (1996), 2.3.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "server/collision/broad_phase.h"
#include "server/collision/collision.h"
#include "server/collision/moving_triangle.h"
#include "server/collision/shapes.h"

namespace visum::collision {

// CollisionStage owns it; tick's thread. Nothing fails, and nothing is allocated once warm.
class Sweep {
 public:
  Sweep(const std::vector<PreparedShape>& shapes, const world::WorldModel& model);

  // Measures the ways, and says of which kind a body moved so far that it may have crossed something.
  FastBodies find_fast(const world::WorldState& before, const world::WorldState& after);
  // Moves each body of `after` that would have crossed another one since `before` back to where they touch.
  // Places the shapes anew and changes their near_W. The result depends on the two states alone.
  void hold_back(std::vector<PreparedShape>& shapes, BroadPhase& broad, const world::WorldState& before,
                 world::WorldState& after);
  // Two shapes that pass through each other on their way from `before` to `after`.
  struct Crossing {
    std::uint32_t first, second;  // indices of the shapes, in order
    double share;                 // of the way, after which they first touch
    double thickness;             // m, half of both
    // For either body, if it is linked: the smallest number of a body that joints connect with it; else
    // kNone.
    std::size_t first_mechanism, second_mechanism;
  };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  // The crossings of linked bodies with each other and with bodies that nothing moves, the earliest first.
  // Left out are those that touch from the beginning, and those of two engines. Changes the shapes as
  // hold_back() does. Valid until the next call.
  const std::vector<Crossing>& find_crossings(std::vector<PreparedShape>& shapes, BroadPhase& broad,
                                              const world::WorldState& before,
                                              const world::WorldState& after);
  // For the two states of the last find_crossings(): puts a body where it is after a share of its way.
  void put(world::BodyId body, double share, const world::WorldState& before, const world::WorldState& after,
           world::WorldState& at) const;
  // Where a point of a shape's surface is after the share `to` of the way, if it is at p_W after the share
  // `from`. The surface of what is round does not move where it spins.
  Eigen::Vector3d carry(const PreparedShape& shape, const Eigen::Vector3d& p_W, double from, double to,
                        const world::WorldState& before, const world::WorldState& after) const;

 private:
  // Whose way a search follows: that of bodies that no joint holds, or of those that joints hold. Fixed and
  // kinematic bodies are neither.
  enum class Kind { kOther, kFree, kLinked };
  struct Body {  // by BodyId
    Kind kind = Kind::kOther;
    std::size_t mechanism = kNone;
    double thickness = 0.0;      // m, half of the smallest side of its thinnest shape
    double turning_reach = 0.0;  // m, from the centre of mass to the farthest point that turning moves
    // In B, unit, through the centre of mass: the shape is round about it, and spin moves nothing. 0: none.
    Eigen::Vector3d round_B = Eigen::Vector3d::Zero();
    // In this tick:
    Eigen::Vector3d way = Eigen::Vector3d::Zero();  // m, of the centre of mass
    double turn = 0.0;                              // m, at least as far as turning moves any point
    // m: a linked body's way bends as its velocity in the end says. Halfway it is off the line by a quarter
    // of this.
    Eigen::Vector3d bend = Eigen::Vector3d::Zero();
    // Where it first touches something:
    double share = 1.0;  // of the tick; 1: nowhere
    world::BodyId other;
  };
  struct Way;

  void number_mechanisms();
  Way way_of(const PreparedShape& shape, const world::WorldState& before,
             const world::WorldState& after) const;

  // Fills pairs_ with pairs of shapes that may cross. The first is of the body that is held back, if it is
  // free.
  void list_pairs(Kind kind, std::vector<PreparedShape>& shapes, BroadPhase& broad,
                  const world::WorldState& before, const world::WorldState& after);
  void add_pair(Kind kind, const std::vector<PreparedShape>& shapes, const IndexPair& pair);
  // The share of the tick after which the first shape touches the second; none if it need not be held back.
  std::optional<double> first_touch(const Way& held, const Way& other);
  std::optional<double> first_touch_with_mesh(const Way& mesh, const Way& convex);
  std::optional<double> first_touch_of_convex(const Way& way_a, Placed a, const Way& way_b, Placed b,
                                              double thickness);
  static double beyond_boxes(const Body& body);
  static double closing_by_turn(const Body& body, const Eigen::Vector3d& axis, const Eigen::Vector3d& along);
  std::pair<Eigen::Vector3d, double> least_overlap(const Placed& a, const Placed& b);
  // Leaves a body where it touches: in the frame of the other body, which goes on.
  void leave_at_touch(std::size_t body, const world::WorldState& before, world::WorldState& after) const;

  const world::WorldModel& model_;
  std::vector<Body> bodies_;
  std::vector<std::size_t> moving_;  // bodies with shapes that are not fixed
  std::vector<IndexPair> pairs_;
  std::vector<Crossing> crossings_;
  GjkSolver solver_;
  MovingTriangle triangle_;
};

}  // namespace visum::collision
