#include "server/dynamics/ode/ode_world.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace visum::dynamics::ode {
namespace {

// m/s, fastest separation of overlapping bodies: a body that starts inside another one is not shot out of it.
constexpr double kMaxSeparatingSpeed = 0.5;
// m, overlap that is left alone: a contact at rest then exists in every tick. Nobody measures as little as 10
// µm.
constexpr double kSurfaceLayerM = 1e-5;
// Iterations where the iterative solver does a tick that the direct one has given up on.
constexpr int kStandInIterations = 200;

void set_mass(dBodyID id, const world::Body& body) {
  const Eigen::Matrix3d& i = body.inertia_C;
  // The constructor of dMass would call ODE past our pointers. dMassSetParameters() sets all of it.
  alignas(dMass) std::array<std::byte, sizeof(dMass)> storage;
  auto* const mass = reinterpret_cast<dMass*>(storage.data());
  dMassSetParameters(mass, body.mass_kg, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
  dBodySetMass(id, mass);
}

// dBodySetQuaternion() would normalise once more and change the last bit. ODE itself applies dQtoR() after
// each step, so the matrix comes back with the same bits, too.
void write_raw(dBodyID id, const world::BodyState& state) {
  dBodySetPosition(id, state.p_WC.x(), state.p_WC.y(), state.p_WC.z());
  auto* q = const_cast<dReal*>(dBodyGetQuaternion(id));
  q[0] = state.q_WB.w();
  q[1] = state.q_WB.x();
  q[2] = state.q_WB.y();
  q[3] = state.q_WB.z();
  dQtoR(q, const_cast<dReal*>(dBodyGetRotation(id)));
  dBodySetLinearVel(id, state.v_WC.x(), state.v_WC.y(), state.v_WC.z());
  dBodySetAngularVel(id, state.w_WB.x(), state.w_WB.y(), state.w_WB.z());
  dBodySetForce(id, 0, 0, 0);
  dBodySetTorque(id, 0, 0, 0);
}

}  // namespace

OdeWorld::OdeWorld(const world::WorldModel& model, std::int32_t engine_index)
    : model_(model),
      engine_index_(engine_index),
      world_(dWorldCreate()),
      bodies_(model.bodies.size(), nullptr) {
  const world::EngineSetting& setting = model.engines[static_cast<std::size_t>(engine_index)];
  dWorldSetGravity(id(), model.gravity.x(), model.gravity.y(), model.gravity.z());
  dWorldSetERP(id(), setting.erp);
  dWorldSetCFM(id(), setting.cfm);
  dWorldSetQuickStepNumIterations(id(), setting.step == "quick" ? setting.iterations : kStandInIterations);
  dWorldSetContactMaxCorrectingVel(id(), kMaxSeparatingSpeed);
  dWorldSetContactSurfaceLayer(id(), kSurfaceLayerM);
  dWorldSetAutoDisableFlag(id(), 0);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const world::BodyId body{static_cast<std::int32_t>(i)};
    if (model.bodies[i].fixed) continue;
    bodies_[i] = dBodyCreate(id());
    if (owns(body)) {
      own_.push_back(body);
      set_mass(bodies_[i], model.bodies[i]);
      dBodySetGyroscopicMode(bodies_[i], 1);
    } else {
      stand_ins_.push_back(body);
      dBodySetKinematic(bodies_[i]);
    }
  }
}

bool OdeWorld::owns(world::BodyId id) const {
  if (!id.valid()) return false;
  const world::Body& body = model_.bodies[id.index()];
  return !body.fixed && body.engine == engine_index_;
}

void OdeWorld::place_link(world::BodyId id, const world::Pose& X_WB) {
  const world::Body& body = model_.bodies[id.index()];
  write_raw(bodies_[id.index()],
            {X_WB * body.p_BC, X_WB.q, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
}

void OdeWorld::load(const world::WorldState& state) {
  for (const world::BodyId id : own_) write_raw(bodies_[id.index()], state.bodies[id.index()]);
  for (const world::BodyId id : stand_ins_) dBodyDisable(bodies_[id.index()]);
}

void OdeWorld::wake_stand_in(world::BodyId id, const world::WorldState& state) {
  write_raw(bodies_[id.index()], state.bodies[id.index()]);
  dBodyEnable(bodies_[id.index()]);
}

void OdeWorld::store(world::WorldState& state) const {
  for (const world::BodyId id : own_) {
    world::BodyState& body = state.bodies[id.index()];
    const dReal* q = dBodyGetQuaternion(bodies_[id.index()]);
    body.p_WC = Eigen::Map<const Eigen::Vector3d>(dBodyGetPosition(bodies_[id.index()]));
    body.q_WB = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    body.v_WC = Eigen::Map<const Eigen::Vector3d>(dBodyGetLinearVel(bodies_[id.index()]));
    body.w_WB = Eigen::Map<const Eigen::Vector3d>(dBodyGetAngularVel(bodies_[id.index()]));
  }
}

}  // namespace visum::dynamics::ode
