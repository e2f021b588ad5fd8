// The probe of sensors that plug-ins bring. It measures nothing itself: it shows the plug-in the world, as
// far as a sensor may know it, and the plug-in measures. Nonsense from the plug-in throws plugin::Error,
// which becomes a fault of that sensor.
#include <limits>

#include "hwparts/plugged/plugged_sensor.h"
#include "server/sensing/probes.h"

namespace visum::sensing {
namespace {

plugin::Pose plain(const world::Pose& pose) {
  return {{pose.p.x(), pose.p.y(), pose.p.z()}, {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()}};
}

void put(const Eigen::Vector3d& from, double to[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

class MomentTruth final : public plugin::Truth {
 public:
  MomentTruth(const Moment& moment, const Mount& mount)
      : moment_(moment), mount_(mount), X_WS_(sensing::pose_of(mount, moment.model, moment.now)) {}

  std::int64_t time_ns() const override { return moment_.now.tick * moment_.model.tick_ns; }
  double tick_s() const override { return moment_.tick_s; }
  plugin::Pose pose() const override { return plain(X_WS_); }

  void velocity(double linear[3], double angular[3]) const override {
    put(velocity_of(mount_, moment_.model, moment_.now), linear);
    const bool carried = mount_.body.valid();
    put(carried ? moment_.now.bodies[mount_.body.index()].w_WB : Eigen::Vector3d::Zero(), angular);
  }

  double distance(const double direction[3], double farthest) const override {
    if (!moment_.rays) throw plugin::Error("asks for a distance, and did not say that it wants rays");
    const Eigen::Vector3d direction_S(direction[0], direction[1], direction[2]);
    const double length = direction_S.norm();
    if (!(length > 0.0 && length < std::numeric_limits<double>::infinity()))
      throw plugin::Error("asks for a distance along no direction");
    if (!(farthest > 0.0 && farthest <= kFarthest_m))
      throw plugin::Error("asks for a distance that is not within 0 and 1e6 m");
    const Hit hit = moment_.rays->cast({X_WS_.p, X_WS_.q * (direction_S / length), farthest, mount_.body});
    return hit.shape.valid() ? hit.distance_m : std::numeric_limits<double>::infinity();
  }

  double normal_force_n() const override {
    double sum = 0.0;
    for (const auto& contact : moment_.contacts)
      if (mount_.body.valid() && (contact.body_a == mount_.body || contact.body_b == mount_.body))
        sum += contact.normal_force_n;
    return sum;
  }

  bool pose_of(std::string_view body, plugin::Pose& pose) const override {
    const auto& bodies = moment_.model.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (bodies[i].name != body) continue;
      pose = plain(world::link_pose(bodies[i], moment_.now.bodies[i]));
      return true;
    }
    return false;
  }

 private:
  static constexpr double kFarthest_m = 1e6;

  const Moment& moment_;
  const Mount& mount_;
  const world::Pose X_WS_;
};

class PluggedProbe : public Probe {
 public:
  PluggedProbe(const Mount& mount, bool wants_rays) : mount_(mount), wants_rays_(wants_rays) {}

  bool wants_rays() const override { return wants_rays_; }
  void attach(sensors::Sensor& sensor) override { sensor_ = static_cast<plugged::PluggedSensor*>(&sensor); }
  void measure(const Moment& moment, std::span<double>) override {
    sensor_->measure(MomentTruth(moment, mount_));
  }

 private:
  const Mount mount_;
  const bool wants_rays_;
  plugged::PluggedSensor* sensor_ = nullptr;
};

}  // namespace

std::unique_ptr<Probe> make_plugged_probe(const Mount& mount, const plugged::PluggedSensor& sensor) {
  return std::make_unique<PluggedProbe>(mount, sensor.wants_rays());
}

}  // namespace visum::sensing
