// The arm's shapes, in the scene that ships: nothing touches at the start, and each joint can go from stop to
// stop without a link touching the next but one.
#include <gtest/gtest.h>

#include <string>

#include "server/collision/collision.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"

namespace visum {
namespace {

class ArmShapes : public testing::Test {
 protected:
  ArmShapes()
      : scene_(scene::load_scene(VISUM_SOURCE_DIR "/models/scenes/amtec_arm.yaml")), stage_(scene_.world) {}

  void set(const std::string& joint, double position) {
    const world::JointId id = scene_.world.find_joint("arm/" + joint);
    ASSERT_TRUE(id.valid()) << joint;
    scene_.world.joints[id.index()].initial_position = position;
  }
  double upper(const std::string& joint) const {
    return scene_.world.joints[scene_.world.find_joint("arm/" + joint).index()].upper;
  }

  // "a - b" of the first contact that is deeper than rounding, between links of the arm or with its
  // surroundings as well; empty if there is none.
  std::string first_contact(bool with_surroundings = false) {
    std::vector<collision::Contact> contacts;
    stage_.find(world::initial_state(scene_.world), contacts);
    for (const auto& contact : contacts) {
      const auto& a = scene_.world.bodies[contact.body_a.index()];
      const auto& b = scene_.world.bodies[contact.body_b.index()];
      const bool counts = with_surroundings ? a.model == "arm" || b.model == "arm" : a.model == b.model;
      if (counts && contact.depth > 1e-6) return a.name + " - " + b.name;
    }
    return {};
  }

  void expect_free_sweep(const std::string& bending, const std::string& turning,
                         const std::string& turning_after) {
    for (const double turn : {0.0, 0.4, 0.785, 1.2, 1.57}) {
      for (const double turn_after : {0.0, 0.785, 1.57}) {
        for (double share = -1.0; share <= 1.0; share += 0.1) {
          set(bending, share * upper(bending));
          set(turning, turn);
          set(turning_after, turn_after);
          EXPECT_EQ(first_contact(), "") << bending << " " << share * upper(bending) << ", " << turning << " "
                                         << turn << ", " << turning_after << " " << turn_after;
        }
      }
    }
  }

  void stretch() {
    for (int i = 1; i <= 7; ++i) set("joint_" + std::to_string(i), 0.0);
  }

  scene::Scene scene_;
  collision::CollisionStage stage_;
};

TEST_F(ArmShapes, TouchNothingAtTheStart) {
  EXPECT_EQ(first_contact(true), "");
}

TEST_F(ArmShapes, TouchNothingStraightUp) {
  stretch();
  EXPECT_EQ(first_contact(true), "");
}

TEST_F(ArmShapes, LetTheShoulderGoFromStopToStop) {
  stretch();
  expect_free_sweep("joint_2", "joint_1", "joint_3");
}

TEST_F(ArmShapes, LetTheElbowGoFromStopToStop) {
  stretch();
  expect_free_sweep("joint_4", "joint_3", "joint_5");
}

TEST_F(ArmShapes, LetTheWristGoFromStopToStop) {
  stretch();
  expect_free_sweep("joint_6", "joint_5", "joint_7");
}

TEST_F(ArmShapes, LetTheFingersCloseAndOpen) {
  for (const double share : {0.001, 0.5, 1.0}) {
    set("finger_left_joint", share * upper("finger_left_joint"));
    set("finger_right_joint", share * upper("finger_right_joint"));
    EXPECT_EQ(first_contact(), "") << share;
  }
}

}  // namespace
}  // namespace visum
