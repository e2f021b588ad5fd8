#include "tests/bench/peers/bullet_bodies.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "server/world/joint_tree.h"
#include "tests/bench/peers/bullet_types.h"

namespace visum::bench {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using world::JointKind;
using world::Pose;

constexpr double kSmall = 1e-12;  // m, rad, kg·m²

// Bodies that are one for Bullet. Their frame G is at their common centre of mass, with the axes of the body
// that they hang on.
struct Group {
  std::size_t root = 0;
  std::vector<std::size_t> members;
  double mass_kg = 0.0;                 // 0: scenery
  Vector3d inertia = Vector3d::Zero();  // kg·m², about the axes of G
  Pose X_WG;                            // at the start
};

// By body: the one that it hangs on by fixed joints alone.
std::vector<std::size_t> roots(const world::WorldModel& model) {
  const auto carrying = carrying_joints(model);
  std::vector<std::size_t> roots(model.bodies.size());
  for (std::size_t i = 0; i < roots.size(); ++i) {
    roots[i] = i;
    for (world::JointId id = carrying[i]; id.valid(); id = carrying[roots[i]]) {
      const world::Joint& joint = model.joints[id.index()];
      if (joint.kind != JointKind::kFixed || !joint.parent.valid()) break;
      roots[i] = joint.parent.index();
    }
  }
  return roots;
}

Pose centre_of(const world::Body& body) {
  return body.X_WB * Pose{body.p_BC, Eigen::Quaterniond::Identity()};
}

void weigh(const world::WorldModel& model, Group& group) {
  group.X_WG = centre_of(model.bodies[group.root]);
  if (model.bodies[group.root].fixed) return;
  Vector3d moment = Vector3d::Zero();
  for (const std::size_t i : group.members) {
    group.mass_kg += model.bodies[i].mass_kg;
    moment += model.bodies[i].mass_kg * centre_of(model.bodies[i]).p;
  }
  group.X_WG.p = moment / group.mass_kg;
  Matrix3d inertia = Matrix3d::Zero();
  for (const std::size_t i : group.members) {
    const Pose X_GC = group.X_WG.inverse() * centre_of(model.bodies[i]);
    const Matrix3d R = X_GC.q.toRotationMatrix();
    inertia +=
        R * model.bodies[i].inertia_C * R.transpose() +
        model.bodies[i].mass_kg * (X_GC.p.squaredNorm() * Matrix3d::Identity() - X_GC.p * X_GC.p.transpose());
  }
  group.inertia = inertia.diagonal();
  if (!inertia.isDiagonal(kSmall)) throw std::runtime_error("Bullet: the axes are not the principal ones");
}

class BulletBodies : public Stepper {
 public:
  explicit BulletBodies(const world::WorldModel& model)
      : model_(model),
        start_(initial_state(model)),
        tick_s_(1e-9 * static_cast<double>(model.tick_ns)),
        group_of_(model.bodies.size()) {
    world_.setGravity(bt(model.gravity));
    gather();
    for (const Group& group : groups_) add(group);
    place_at_start();
    for (const auto& body : bodies_) enter(*body);
    for (const auto& joint : model_.joints) add(joint);
    for (const auto& [a, b] : model_.no_collision) {
      rigid(a).setIgnoreCollisionCheck(&rigid(b), true);
      rigid(b).setIgnoreCollisionCheck(&rigid(a), true);
    }
  }
  ~BulletBodies() override {
    for (const auto& constraint : constraints_) world_.removeConstraint(constraint.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  BulletBodies(const BulletBodies&) = delete;
  BulletBodies& operator=(const BulletBodies&) = delete;

  // Takes the bodies out and in again, so that no contact and no pair of the run before remains.
  void reset() override {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    broadphase_.resetPool(&dispatcher_);
    place_at_start();
    for (const auto& body : bodies_) enter(*body);
    solver_.reset();
  }
  void step() override { world_.stepSimulation(tick_s_, 0); }
  void store(world::WorldState& state) const override {
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const btTransform& X = bodies_[i]->getWorldTransform();
      const Pose X_WG{eigen(X.getOrigin()), eigen(X.getRotation())};
      const Vector3d v = eigen(bodies_[i]->getLinearVelocity()), w = eigen(bodies_[i]->getAngularVelocity());
      for (const std::size_t member : groups_[i].members) {
        const Pose X_WC = X_WG * (groups_[i].X_WG.inverse() * centre_of(model_.bodies[member]));
        state.bodies[member] = {X_WC.p, X_WC.q, v + w.cross(X_WC.p - X_WG.p), w};
      }
    }
  }

 private:
  void gather() {
    const auto root_of = roots(model_);
    for (std::size_t i = 0; i < root_of.size(); ++i) {
      if (root_of[i] != i) continue;
      group_of_[i] = groups_.size();
      groups_.push_back({i, {}});
    }
    for (std::size_t i = 0; i < root_of.size(); ++i) {
      group_of_[i] = group_of_[root_of[i]];
      groups_[group_of_[i]].members.push_back(i);
    }
    for (Group& group : groups_) weigh(model_, group);
  }

  void place_at_start() {
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const Pose& X_WG = groups_[i].X_WG;
      const auto& motion = start_.bodies[groups_[i].root];
      bodies_[i]->setLinearVelocity(bt(Vector3d(motion.v_WC + motion.w_WB.cross(X_WG.p - motion.p_WC))));
      bodies_[i]->setAngularVelocity(bt(motion.w_WB));
      bodies_[i]->clearForces();
      // Unlike setWorldTransform(), this turns the inertia, too.
      bodies_[i]->setCenterOfMassTransform(btTransform(bt(X_WG.q), bt(X_WG.p)));
    }
  }

  // A body without a shape meets no other.
  void enter(btRigidBody& body) {
    if (body.getCollisionShape()->getShapeType() == EMPTY_SHAPE_PROXYTYPE)
      world_.addRigidBody(&body, 0, 0);
    else
      world_.addRigidBody(&body);
  }

  btRigidBody& rigid(world::BodyId id) { return *bodies_[group_of_[id.index()]]; }

  // The friction of a pair is the product of both bodies'.
  void add(const Group& group) {
    btCollisionShape* whole = nullptr;
    double friction = 0.0;
    for (const world::Shape& shape : model_.shapes) {
      if (std::ranges::find(group.members, shape.body.index()) == group.members.end()) continue;
      whole = with(whole, group.X_WG.inverse() * model_.bodies[shape.body.index()].X_WB * shape.X_BS, shape);
      friction = model_.surfaces[shape.surface.index()].friction;
    }
    if (!whole) whole = keep(std::make_unique<btEmptyShape>());
    const btRigidBody::btRigidBodyConstructionInfo facts(group.mass_kg, nullptr, whole, bt(group.inertia));
    bodies_.push_back(std::make_unique<btRigidBody>(facts));
    bodies_.back()->setFriction(std::sqrt(friction));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
  }

  template <typename Shape>
  Shape* keep(std::unique_ptr<Shape> shape) {
    Shape* kept = shape.get();
    shapes_.push_back(std::move(shape));
    return kept;
  }

  // One shape at the centre of mass stands for itself, any others make a compound.
  btCollisionShape* with(btCollisionShape* whole, const Pose& X_GS, const world::Shape& shape) {
    const auto& [x, y, z] = shape.size;
    if (shape.kind == world::ShapeKind::kPlane) {
      const Vector3d up = X_GS.q * Vector3d::UnitZ();
      return keep(std::make_unique<btStaticPlaneShape>(bt(up), up.dot(X_GS.p)));
    }
    btCollisionShape* single = nullptr;
    if (shape.kind == world::ShapeKind::kSphere)
      single = keep(std::make_unique<btSphereShape>(x));
    else
      single = keep(std::make_unique<btBoxShape>(0.5 * btVector3(x, y, z)));
    const bool centred = X_GS.p.norm() < kSmall && X_GS.q.vec().norm() < kSmall;
    if (!whole && centred) return single;
    auto* compound = dynamic_cast<btCompoundShape*>(whole);
    if (!compound) {
      compound = keep(std::make_unique<btCompoundShape>());
      if (whole) compound->addChildShape(btTransform::getIdentity(), whole);
    }
    compound->addChildShape(btTransform(bt(X_GS.q), bt(X_GS.p)), single);
    return compound;
  }

  void add(const world::Joint& joint) {
    if (joint.kind == JointKind::kFixed) return;
    btRigidBody& child = rigid(joint.child);
    btRigidBody& parent = joint.parent.valid() ? rigid(joint.parent) : btTypedConstraint::getFixedBody();
    const btTransform X_child = frame(joint.child, joint.X_CJ, joint.axis_J);
    const btTransform X_parent = frame(joint.parent, joint.X_PJ, joint.axis_J);
    if (joint.kind == JointKind::kBall)
      constraints_.push_back(std::make_unique<btPoint2PointConstraint>(child, parent, X_child.getOrigin(),
                                                                       X_parent.getOrigin()));
    else
      constraints_.push_back(hinge(joint, child, parent, X_child, X_parent));
    world_.addConstraint(constraints_.back().get(), true);
  }

  std::unique_ptr<btHingeConstraint> hinge(const world::Joint& joint, btRigidBody& child, btRigidBody& parent,
                                           const btTransform& X_child, const btTransform& X_parent) const {
    auto hinge = std::make_unique<btHingeConstraint>(child, parent, X_child, X_parent);
    if (joint.limited) hinge->setLimit(joint.lower, joint.upper);
    if (joint.friction > 0.0) hinge->enableAngularMotor(true, 0.0, joint.friction * tick_s_);
    return hinge;
  }

  // The joint's frame in that of the body's group, with the axis along z as Bullet wants it.
  btTransform frame(world::BodyId id, const Pose& X_BJ, const Vector3d& axis_J) const {
    const Pose X_JZ{Vector3d::Zero(), Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis_J)};
    Pose X = X_BJ * X_JZ;
    if (id.valid()) X = groups_[group_of_[id.index()]].X_WG.inverse() * model_.bodies[id.index()].X_WB * X;
    return btTransform(bt(X.q), bt(X.p));
  }

  const world::WorldModel model_;
  const world::WorldState start_;
  const double tick_s_;
  std::vector<std::size_t> group_of_;  // by body
  std::vector<Group> groups_;

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;  // by group
  std::vector<std::unique_ptr<btTypedConstraint>> constraints_;
};

}  // namespace

bool is_bullet_scene(const world::WorldModel& model) {
  if (is_boxes_only(model)) return true;
  return is_jointed_scene(model) && !has_springs(model) &&
         std::ranges::all_of(model.joints, [](const auto& joint) { return joint.damping == 0.0; });
}

std::unique_ptr<Stepper> make_bullet_bodies(const world::WorldModel& model) {
  return std::make_unique<BulletBodies>(model);
}

}  // namespace visum::bench
