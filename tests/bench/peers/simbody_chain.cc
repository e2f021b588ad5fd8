#include "tests/bench/peers/simbody_chain.h"

#include <Simbody.h>

namespace visum::bench {
namespace {

SimTK::Vec3 vec3(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Eigen::Vector3d eigen(const SimTK::Vec3& v) {
  return {v[0], v[1], v[2]};
}

// A pin turns about z of its frames.
SimTK::Transform pin_frame(const Eigen::Vector3d& p, const Eigen::Vector3d& axis) {
  return {SimTK::Rotation(SimTK::UnitVec3(vec3(axis)), SimTK::ZAxis), vec3(p)};
}

SimTK::Body::Rigid rigid(const Pin& pin) {
  const Eigen::Matrix3d& j = pin.inertia;
  const SimTK::Inertia central(j(0, 0), j(1, 1), j(2, 2), j(0, 1), j(0, 2), j(1, 2));
  const SimTK::Vec3 com = vec3(pin.p_com);
  return SimTK::Body::Rigid(
      SimTK::MassProperties(pin.mass_kg, com, central.shiftFromMassCenter(com, pin.mass_kg)));
}

}  // namespace

struct SimbodyChain::Impl {
  Impl(const Eigen::Vector3d& gravity, double tick, const std::vector<Pin>& pins)
      : tick_s(tick), matter(system), forces(system), uniform(forces, matter, vec3(gravity)) {
    for (const Pin& pin : pins) {
      SimTK::MobilizedBody& parent =
          pin.parent < 0 ? matter.Ground() : links[static_cast<std::size_t>(pin.parent)];
      links.push_back(SimTK::MobilizedBody::Pin(parent, pin_frame(pin.p_joint, pin.axis), rigid(pin),
                                                pin_frame(Eigen::Vector3d::Zero(), pin.axis)));
    }
    start = system.realizeTopology();
    for (std::size_t i = 0; i < pins.size(); ++i) links[i].setOneQ(start, 0, pins[i].q0);
  }

  const double tick_s;
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  SimTK::Force::UniformGravity uniform;
  std::vector<SimTK::MobilizedBody> links;
  SimTK::State start;
  std::unique_ptr<SimTK::SemiExplicitEulerIntegrator> integrator;
  long steps = 0;
};

SimbodyChain::SimbodyChain(const Eigen::Vector3d& gravity, double tick_s, const std::vector<Pin>& pins)
    : impl_(new Impl(gravity, tick_s, pins)) {
  reset();
}

SimbodyChain::~SimbodyChain() = default;

void SimbodyChain::reset() {
  impl_->integrator.reset(new SimTK::SemiExplicitEulerIntegrator(impl_->system, impl_->tick_s));
  impl_->integrator->setAllowInterpolation(false);
  impl_->integrator->initialize(impl_->start);
  impl_->steps = 0;
}

void SimbodyChain::step() {
  impl_->integrator->stepTo(impl_->tick_s * static_cast<double>(++impl_->steps));
}

std::vector<PinMotion> SimbodyChain::motions() const {
  SimTK::State now = impl_->integrator->getState();
  impl_->system.realize(now, SimTK::Stage::Velocity);
  std::vector<PinMotion> motions;
  for (const SimTK::MobilizedBody& link : impl_->links) {
    const SimTK::Vec4 q = link.getBodyRotation(now).convertRotationToQuaternion().asVec4();
    const SimTK::Vec3 com = link.getBodyMassCenterStation(now);
    motions.push_back({eigen(link.findStationLocationInGround(now, com)),
                       eigen(link.findStationVelocityInGround(now, com)),
                       eigen(link.getBodyAngularVelocity(now)), Eigen::Quaterniond(q[0], q[1], q[2], q[3])});
  }
  return motions;
}

}  // namespace visum::bench
