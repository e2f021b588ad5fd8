// Kinds `imu`, `pose` and `contact`.
#include <algorithm>

#include "server/sensing/probes.h"

namespace visum::sensing {
namespace {

void put(const Eigen::Vector3d& vector, std::span<double> to) {
  for (int axis = 0; axis < 3; ++axis) to[static_cast<std::size_t>(axis)] = vector[axis];
}

// The acceleration is the mean over the tick: the change of the velocity, divided by the tick's length.
class ImuProbe : public Probe {
 public:
  explicit ImuProbe(const ProbeContext& context) : mount_(context.mount) {}

  void measure(const Moment& moment, std::span<double> truth) override {
    const Eigen::Quaterniond to_S = pose_of(mount_, moment.model, moment.now).q.conjugate();
    Eigen::Vector3d w_W = Eigen::Vector3d::Zero(), acceleration_W = Eigen::Vector3d::Zero();
    if (mount_.body.valid()) {
      w_W = moment.now.bodies[mount_.body.index()].w_WB;
      acceleration_W =
          (velocity_of(mount_, moment.model, moment.now) - velocity_of(mount_, moment.model, moment.before)) /
          moment.tick_s;
    }
    put(to_S * w_W, truth.first(3));
    put(to_S * (acceleration_W - moment.model.gravity), truth.subspan(3));
  }

 private:
  Mount mount_;
};

class PoseProbe : public Probe {
 public:
  explicit PoseProbe(const ProbeContext& context) : mount_(context.mount) {}

  void measure(const Moment& moment, std::span<double> truth) override {
    const world::Pose X_WS = pose_of(mount_, moment.model, moment.now);
    put(X_WS.p, truth.first(3));
    const double parts[] = {X_WS.q.w(), X_WS.q.x(), X_WS.q.y(), X_WS.q.z()};
    std::ranges::copy(parts, truth.begin() + 3);
  }

 private:
  Mount mount_;
};

class ContactProbe : public Probe {
 public:
  explicit ContactProbe(const ProbeContext& context) : body_(context.mount.body) {
    if (!body_.valid()) context.config.fail("a contact sensor needs 'body': what it feels touches that");
  }

  void measure(const Moment& moment, std::span<double> truth) override {
    truth[0] = 0.0;
    for (const auto& contact : moment.contacts)
      if (contact.body_a == body_ || contact.body_b == body_) truth[0] += contact.normal_force_n;
  }

 private:
  world::BodyId body_;
};

}  // namespace

std::unique_ptr<Probe> make_imu_probe(const ProbeContext& context) {
  return std::make_unique<ImuProbe>(context);
}

std::unique_ptr<Probe> make_pose_probe(const ProbeContext& context) {
  return std::make_unique<PoseProbe>(context);
}

std::unique_ptr<Probe> make_contact_probe(const ProbeContext& context) {
  return std::make_unique<ContactProbe>(context);
}

}  // namespace visum::sensing
