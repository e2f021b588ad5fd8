// Steps are cut where a link would swing too fast about its joints under their tension (predicting.cc), and
// only there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::dynamics::impulse {
namespace {

using Eigen::Vector3d;
using testing::at;
using testing::BodyId;
using testing::Lab;
using testing::ModelBuilder;
using world::JointKind;

constexpr double kTickS = 1e-3;

ModelBuilder builder(double tick_s) {
  ModelBuilder b(physics::engine_row("impulse").setting);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  return b;
}

// The largest change of the energy, as a share of energy_scale().
double drift_of(Lab& lab, double seconds) {
  const double start = physics::energy_of(lab.model, lab.state), scale = physics::energy_scale(lab.model);
  double drift = 0.0;
  for (int tick = 0; tick < std::lround(seconds / lab.tick_s()); ++tick) {
    lab.run_ticks(1);
    drift = std::max(drift, std::abs(physics::energy_of(lab.model, lab.state) - start) / scale);
  }
  return drift;
}

// A leg of 5 kg hangs on three hinges at one point, and swings. Between them are two links of a
// ten-thousandth of its mass, with their centres of mass where the leg has its own: so a hip stands in MJCF
// and URDF.
TEST(TautLinks, StackedHingesAreNotCut) {
  ModelBuilder b = builder(kTickS);
  const Vector3d centre(0.2, 0.1, -0.2);
  BodyId last;
  for (const auto& [name, mass_kg, axis] :
       {std::tuple{"swings_x", 0.0005, Vector3d(1, 0, 0)}, std::tuple{"swings_z", 0.0005, Vector3d(0, 0, 1)},
        std::tuple{"leg", 5.0, Vector3d(0, 1, 0)}}) {
    const BodyId link = b.add_rotor(name, mass_kg, mass_kg * 0.002, at(centre.x(), centre.y(), centre.z()));
    b.add_joint(std::string("hip_") + name, JointKind::kHinge, last, link, Vector3d::Zero(), axis);
    last = link;
  }
  Lab lab(b.model);
  EXPECT_LT(drift_of(lab, 3.0), 1e-4);
  EXPECT_EQ(lab.warned_ticks, 0);
}

// Three rods of 10 g with parallel hinges, and 10 kg on the last one's end. The rods do swing alone.
TEST(TautLinks, LightRodsUnderAHeavyEndAreCut) {
  ModelBuilder b = builder(5 * kTickS);
  BodyId last;
  for (int i = 0; i < 3; ++i) {
    const BodyId rod = b.add_box("rod" + std::to_string(i), {0.2, 0.01, 0.01}, 0.01, at(0.1 + 0.2 * i, 0, 0));
    b.add_joint("hinge" + std::to_string(i), JointKind::kHinge, last, rod, Vector3d(0.2 * i, 0, 0),
                Vector3d::UnitY());
    last = rod;
  }
  const BodyId end = b.add_box("end", {0.1, 0.1, 0.1}, 10.0, at(0.65, 0, 0));
  b.add_joint("hook", JointKind::kHinge, last, end, Vector3d(0.6, 0, 0), Vector3d::UnitY());
  Lab lab(b.model);
  EXPECT_LT(drift_of(lab, 3.0), 0.05);
  EXPECT_GT(lab.warned_ticks, 0) << "the case is no longer the one that is meant";
}

}  // namespace
}  // namespace visum::dynamics::impulse
