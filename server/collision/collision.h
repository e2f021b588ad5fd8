// Collision is a stage of its own that serves every engine: broad phase, narrow phase, and contacts in an
// order sorted by stable ids. FCL stays inside gjk.cc, fcl_stage.cc and fcl_templates.cc.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::collision {

class PreparedMeshes;

// One contact point between two shapes; shape_a < shape_b. Lengths in m.
struct Contact {
  world::ShapeId shape_a, shape_b;
  world::BodyId body_a, body_b;
  // Stable number of the point within its pair; from kMaxContactsPerPair on for those that are foreseen.
  std::int32_t feature = 0;
  Eigen::Vector3d p_W;       // midway between the surfaces
  Eigen::Vector3d normal_W;  // unit, from b to a: pushing a along it separates the two
  double depth = 0.0;        // > 0: overlap; < 0: the gap of a foreseen contact
  double friction = 0.0;
  double restitution = 0.0;
  double rolling_friction = 0.0, torsional_friction = 0.0;  // m
  double normal_force_n = 0.0;                              // filled by the engine: mean over the tick
  Eigen::Vector3d force_on_a_W =
      Eigen::Vector3d::Zero();  // N, likewise, friction included; b feels the opposite
  // N·m, likewise: the moment of rolling and torsional friction, beside the moment of the force at p_W. It is
  // 0 from engines of plug-ins, which do not report it, and where a body sleeps.
  Eigen::Vector3d torque_on_a_W = Eigen::Vector3d::Zero();
  // Only of foreseen contacts during a tick, whose p_W is the point of a: from it to that of b.
  Eigen::Vector3d to_b_W = Eigen::Vector3d::Zero();
};

// Tells if bodies that no joint holds, and bodies that joints hold, move so far in a step that they might
// pass through others.
struct FastBodies {
  bool free = false, linked = false;
};

// Simulation owns it; tick's thread. The constructor throws std::runtime_error for a convex shape without
// volume. find() allocates only while its lists grow.
class CollisionStage {
 public:
  CollisionStage(const world::WorldModel& model, PreparedMeshes& meshes);
  explicit CollisionStage(const world::WorldModel& model);  // with prepared meshes of its own
  ~CollisionStage();
  CollisionStage(const CollisionStage&) = delete;
  CollisionStage& operator=(const CollisionStage&) = delete;

  // Replaces `contacts`, sorted by (shape_a, shape_b, feature). The result depends on the bodies' poses
  // alone, so a restored world collides with the same bits; earlier calls only tell which pairs cannot have
  // met, and what those find again of which neither shape has moved by a bit. Returns false if there are more
  // than kMaxContacts; `contacts` then holds the first of them only.
  bool find(const world::WorldState& state, std::vector<Contact>& contacts);

  // After a step: looks how far bodies have moved. None is fast where the model has no continuous collision.
  FastBodies find_fast(const world::WorldState& before, const world::WorldState& after);
  // After a step: leaves fast free bodies where they first touched another body, if they would have passed
  // through it within the tick (sweep.h). They keep their velocity. Does nothing where the model has no
  // continuous collision.
  void hold_back(const world::WorldState& before, world::WorldState& after);
  // After a step that was tried: whether it should be tried again, since linked bodies have passed through
  // others (sweep.h). Then adds to `contacts`, in their order, what they need in that step. The depth of such
  // a contact is below 0: the gap at the step's begin between the points that will touch. Of a mechanism only
  // the first crossings count, since a contact may change what follows. A contact that has not held is made
  // tighter. Without `contacts` it only tells. find() forgets earlier tries.
  bool foresee(const world::WorldState& before, const world::WorldState& after,
               std::vector<Contact>* contacts);
  // After the last try: takes out those that did nothing, and puts the others where they touch.
  void finish_foreseen(std::vector<Contact>& contacts) const;
  // Returns, for the last find(), the bodies of pairs with meshes whose work met its limit (WorldModel::
  // collision_work_limit), each once, in the order of the pairs, at most kMaxNamed. Such pairs keep the
  // contacts of a sample of their triangles. Each pair with a mesh has an equal share of the limit, and what
  // pairs before it have left.
  const std::vector<world::BodyId>& limited() const;
  std::uint64_t work() const;  // of the last find(), in units of work.h
  std::size_t tested() const;  // pairs that the last find() tested: all that met, but for those that stood

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

inline constexpr std::size_t kMaxContactsPerPair = 8;
inline constexpr std::size_t kMaxContacts = 20'000;
inline constexpr std::size_t kMaxNamed = 16;

}  // namespace visum::collision
