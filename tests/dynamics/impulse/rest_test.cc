// A body that stands still is left as it is, and not solved for anew in each tick.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/dynamics/lab.h"

namespace visum::dynamics::testing {
namespace {

// On the way there its impulses stop it. The rest of that must not be answered by the next tick, and so on
// for ever.
TEST(Rest, ForcesOfWhatStandsStillNoLongerChange) {
  world::EngineSetting setting;
  setting.name = "impulse";
  ModelBuilder b(setting);
  b.add_ground();
  b.add_box("below", {0.2, 0.2, 0.2}, 2.0, at(0, 0, 0.1));
  b.add_box("above", {0.1, 0.1, 0.1}, 1.0, at(0.02, 0, 0.25));
  b.add_box("fallen", {0.2, 0.1, 0.1}, 1.0, at(1, 0, 0.06));
  Lab lab(b.model);
  lab.run(1.0);
  int changes = 0;
  double last = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_TRUE(lab.step().ok);
    const double force = lab.normal_force_between("fallen", "ground");
    changes += std::abs(force - last) > 1e-11 * 9.81;
    last = force;
  }
  EXPECT_NEAR(last, 9.81, 1e-6);
  EXPECT_LT(changes, 50);
}

}  // namespace
}  // namespace visum::dynamics::testing
