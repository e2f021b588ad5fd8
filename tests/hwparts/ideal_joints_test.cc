// The part ideal_joints in front of plants that move as its drives say.
#include <gtest/gtest.h>

#include <stdexcept>

#include "hwparts/ideal_joints/ideal_joints.h"
#include "hwparts/kinds/part_kinds.h"

namespace visum::ideal_joints {
namespace {

hwparts::PartContext context(double speed, double effort) {
  hwparts::JointInfo joint{"j", false, -1.0, 1.0, 0.25};
  joint.maximum_speed = speed;
  joint.maximum_effort = effort;
  return {"robot", config::load_text("{name: robot, kind: ideal_joints}", "scene"), {joint}, 0.001};
}

// Moves a joint of no mass by the part's drive for a time.
hwparts::JointSample moved(hwparts::Part& part, double desired, hwparts::JointSample sample, int ticks) {
  std::vector<double> inputs{desired}, outputs(3);
  for (int i = 0; i < ticks; ++i) {
    std::vector<hwparts::JointSample> samples{sample};
    std::vector<hwparts::JointDrive> drives(1);
    part.act(inputs, samples, drives);
    EXPECT_EQ(drives[0].compliance, 0.0);
    sample.velocity = drives[0].target_velocity;
    sample.position += 0.001 * sample.velocity;
    part.publish({&sample, 1}, outputs);
  }
  EXPECT_EQ(outputs[0], sample.position);
  EXPECT_EQ(outputs[1], sample.velocity);
  return sample;
}

TEST(IdealJoints, GoWhereTheyAreToldAtTheModelsSpeed) {
  const auto part = hwparts::make_part("ideal_joints", context(0.5, 7));
  EXPECT_EQ(part->description().controller_inputs[0].name, "Desired Angle 1");
  EXPECT_EQ(part->description().controller_inputs[0].initial, 0.25);
  EXPECT_EQ(part->description().controller_inputs[0].maximum, 1.0);
  const auto sample = moved(*part, 1.0, {0.25, 0, 0}, 1000);
  EXPECT_NEAR(sample.position, 0.75, 1e-9) << "1 s at 0.5 rad/s";
  EXPECT_NEAR(moved(*part, 1.0, sample, 2000).position, 1.0, 1e-6);
  double error = 1;
  part->following_errors({&error, 1});
  EXPECT_NEAR(error, 0.0, 1e-6);
}

TEST(IdealJoints, PullNoHarderThanTheModelSays) {
  const auto part = hwparts::make_part("ideal_joints", context(0, 7));
  std::vector<double> inputs{-1};
  std::vector<hwparts::JointSample> samples(1);
  std::vector<hwparts::JointDrive> drives(1);
  part->act(inputs, samples, drives);
  EXPECT_EQ(drives[0].max_effort, 7);
  EXPECT_EQ(drives[0].target_velocity, -3) << "the default, where the model gives no speed";
}

TEST(IdealJoints, ASnapshotHoldsTheFollowingError) {
  const auto part = hwparts::make_part("ideal_joints", context(0.5, 7));
  moved(*part, 1.0, {}, 10);
  std::vector<std::byte> bytes;
  {
    hwparts::StateWriter writer(bytes);
    part->save(writer);
  }
  const auto other = hwparts::make_part("ideal_joints", context(0.5, 7));
  hwparts::StateReader reader(bytes);
  other->load(reader);
  double a = 0, b = 1;
  part->following_errors({&a, 1});
  other->following_errors({&b, 1});
  EXPECT_EQ(a, b);
  other->reset();
  other->following_errors({&b, 1});
  EXPECT_EQ(b, 0);
}

TEST(IdealJoints, RefuseAnEntryThatIsWrong) {
  auto wrong = context(1, 1);
  wrong.joints.clear();
  EXPECT_THROW(hwparts::make_part("ideal_joints", wrong), config::ConfigError);
  wrong = context(1, 1);
  wrong.config = config::load_text("{name: robot, kind: ideal_joints, drives: a.yaml}", "scene");
  EXPECT_THROW(hwparts::make_part("ideal_joints", wrong), config::ConfigError);
}

}  // namespace
}  // namespace visum::ideal_joints
