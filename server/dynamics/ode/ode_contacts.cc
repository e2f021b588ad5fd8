#include "server/dynamics/ode/ode_contacts.h"

#include <cmath>

namespace visum::dynamics::ode {
namespace {

constexpr double kSoftness = 1e-6;           // (m/s)/N, by which the contacts of one face share the load
constexpr double kLeastBounceSpeed = 0.05;   // m/s: a slower hit does not bounce
constexpr double kLeastSlidingSpeed = 1e-3;  // m/s: above this speed, friction is laid along the sliding

Eigen::Vector3d velocity_at(const world::WorldModel& model, const world::WorldState& state, world::BodyId id,
                            const Eigen::Vector3d& p_W) {
  if (model.bodies[id.index()].fixed) return Eigen::Vector3d::Zero();
  const world::BodyState& body = state.bodies[id.index()];
  return body.v_WC + body.w_WB.cross(p_W - body.p_WC);
}

void copy(const Eigen::Vector3d& from, dReal* to) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

// ODE has one point for both bodies. Where it is not the same for both, that of the slower one counts.
Eigen::Vector3d point_of(const world::WorldModel& model, const world::WorldState& state,
                         const collision::Contact& contact) {
  if (contact.to_b_W.isZero(0.0)) return contact.p_W;
  const Eigen::Vector3d of_b = contact.p_W + contact.to_b_W;
  const double speed_a = velocity_at(model, state, contact.body_a, contact.p_W).squaredNorm();
  return speed_a < velocity_at(model, state, contact.body_b, of_b).squaredNorm() ? contact.p_W : of_b;
}

dContact make_contact(const collision::Contact& contact, const Eigen::Vector3d& p_W,
                      const Eigen::Vector3d& normal_W, const Eigen::Vector3d& relative_velocity,
                      const world::EngineSetting& setting, double tick_s) {
  dContact result{};  // zeroed, because ODE also reads fields that the mode does not name
  copy(p_W, result.geom.pos);
  copy(normal_W, result.geom.normal);
  result.geom.depth = contact.depth;
  dSurfaceParameters& surface = result.surface;
  surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
  surface.mu = contact.friction;
  // Approx1 makes friction proportional to the normal force.
  surface.soft_erp = setting.erp;
  surface.soft_cfm = std::max(kSoftness, setting.cfm);
  if (contact.depth < 0.0) {
    // A foreseen contact: the bodies may close the gap within the tick.
    surface.mode |= dContactMotionN;
    surface.motionN = contact.depth / tick_s;
  } else if (contact.restitution > 0.0) {
    surface.mode |= dContactBounce;
    surface.bounce = contact.restitution;
    surface.bounce_vel = kLeastBounceSpeed;
  }
  // With parameters by axis, ODE also reads those of the second direction.
  if (contact.rolling_friction > 0.0 || contact.torsional_friction > 0.0) {
    surface.mode |= dContactRolling | dContactAxisDep;
    surface.mu2 = surface.mu;
    surface.rho = surface.rho2 = contact.rolling_friction;
    surface.rhoN = contact.torsional_friction;
  }
  // A friction pyramid brakes too strongly across its corners. Laid along the sliding it brakes as a cone
  // does.
  const Eigen::Vector3d sliding = relative_velocity - normal_W * normal_W.dot(relative_velocity);
  if (sliding.norm() > kLeastSlidingSpeed) {
    surface.mode |= dContactFDir1;
    copy(sliding.normalized(), result.fdir1);
  }
  return result;
}

}  // namespace

OdeContacts::OdeContacts() : group_(dJointGroupCreate(0)) {}

void OdeContacts::make(OdeWorld& world, const world::EngineSetting& setting, double tick_s,
                       std::span<const collision::Contact> contacts, const world::WorldState& state) {
  clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (world.owns(contacts[i].body_a) || world.owns(contacts[i].body_b)) made_.push_back({i});
  }
  for (Made& made : made_) {
    const collision::Contact& contact = contacts[made.contact];
    for (const world::BodyId id : {contact.body_a, contact.body_b}) {
      if (!world.owns(id) && world.body(id) != nullptr) world.wake_stand_in(id, state);
    }
    // ODE's first body must be one that moves, and its normal points to it.
    const bool turned = made.turned = world.body(contact.body_a) == nullptr;
    const world::BodyId first = turned ? contact.body_b : contact.body_a;
    const world::BodyId second = turned ? contact.body_a : contact.body_b;
    const Eigen::Vector3d p_W = point_of(world.model(), state, contact);
    made.lever = p_W - Eigen::Map<const Eigen::Vector3d>(dBodyGetPosition(world.body(first)));
    const Eigen::Vector3d normal = turned ? (-contact.normal_W).eval() : contact.normal_W;
    const Eigen::Vector3d relative =
        velocity_at(world.model(), state, first, p_W) - velocity_at(world.model(), state, second, p_W);
    const dContact surface = make_contact(contact, p_W, normal, relative, setting, tick_s);
    const dJointID joint = dJointCreateContact(world.id(), group_.get(), &surface);
    dJointAttach(joint, world.body(first), world.body(second));
    dJointSetFeedback(joint, &made.feedback);
  }
}

void OdeContacts::report(std::span<collision::Contact> contacts) const {
  for (const Made& made : made_) {
    collision::Contact& contact = contacts[made.contact];
    const Eigen::Vector3d force_on_first = Eigen::Map<const Eigen::Vector3d>(made.feedback.f1);
    // The force along the normal is the contact's, whichever body was first.
    contact.normal_force_n = std::abs(force_on_first.dot(contact.normal_W));
    contact.force_on_a_W = made.turned ? Eigen::Vector3d(-force_on_first) : force_on_first;
    if (contact.rolling_friction == 0.0 && contact.torsional_friction == 0.0) continue;
    // The torque of the force at its lever is taken off: the moment of rolling and torsional friction
    // remains.
    const Eigen::Vector3d torque =
        Eigen::Map<const Eigen::Vector3d>(made.feedback.t1) - made.lever.cross(force_on_first);
    contact.torque_on_a_W = made.turned ? Eigen::Vector3d(-torque) : torque;
  }
}

void OdeContacts::clear() {
  dJointGroupEmpty(group_.get());
  made_.clear();
}

}  // namespace visum::dynamics::ode
