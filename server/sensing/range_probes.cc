// Kinds `distance` and `scanner`: one ray along x, or a fan of them about z.
#include <limits>
#include <vector>

#include "hwparts/sensors/range_finder.h"
#include "protocol/config/trig.h"
#include "server/sensing/probes.h"

namespace visum::sensing {
namespace {

class RangeProbe : public Probe {
 public:
  RangeProbe(const ProbeContext& context, const std::vector<double>& angles)
      : mount_(context.mount), reach_m_(sensors::read_reach(context.config).highest_m) {
    for (const double angle : angles) {
      const auto turn = config::sin_cos(angle);
      directions_S_.emplace_back(turn.cos, turn.sin, 0.0);
    }
  }

  bool wants_rays() const override { return true; }
  void measure(const Moment& moment, std::span<double> truth) override {
    const world::Pose X_WS = pose_of(mount_, moment.model, moment.now);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Hit hit = moment.rays->cast({X_WS.p, X_WS.q * directions_S_[i], reach_m_, mount_.body});
      truth[i] = hit.shape.valid() ? hit.distance_m : std::numeric_limits<double>::infinity();
    }
  }

 private:
  Mount mount_;
  double reach_m_;
  std::vector<Eigen::Vector3d> directions_S_;  // unit
};

}  // namespace

std::unique_ptr<Probe> make_distance_probe(const ProbeContext& context) {
  return std::make_unique<RangeProbe>(context, std::vector{0.0});
}

std::unique_ptr<Probe> make_scanner_probe(const ProbeContext& context) {
  return std::make_unique<RangeProbe>(context, sensors::read_beams(context.config));
}

}  // namespace visum::sensing
