// The keys of a drives file and of a part's entry in a scene, and the errors for wrong ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "hwparts/drive/servo_classes.h"
#include "hwparts/servo_group/drive_list.h"
#include "hwparts/servo_group/part_options.h"
#include "tests/hwparts/rig.h"
#include "tests/support/temp_files.h"

namespace visum::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string arm_file() {
  std::ifstream file(VISUM_SOURCE_DIR "/models/amtec_arm/drives.yaml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// The error that the arm's file gives once `what` is replaced by `with`.
std::string error_of(const std::string& what, const std::string& with, double tick_s = 0.001) {
  std::string text = arm_file();
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  if (at == std::string::npos) return "";
  text.replace(at, what.size(), with);
  const test::TempFiles files;
  files.write("models/amtec_arm/drives.yaml", text);
  auto context = arm_context(tick_s);
  context.config = config::load_text("{name: arm, kind: amtec_arm, drives: models/amtec_arm/drives.yaml}",
                                     "scene", files.folder());
  try {
    servo_group::load_drives(context);
    return "";
  } catch (const config::ConfigError& error) {
    return error.what();
  }
}

TEST(DriveData, OfTheArmIsWhatWasIdentified) {
  const double torque[] = {178, 178, 178, 178, 49, 49, 49};
  const double inertia[] = {7.8, 15.2, 8.0, 14.6, 3.6, 5.8, 5.0};
  for (int i = 0; i < 7; ++i) {
    const auto data = arm_drive(i + 1);
    EXPECT_NEAR(data.effort_per_amp() * data.motor.current_limit, torque[i], 0.5);
    EXPECT_NEAR(data.reflected_inertia(), inertia[i], 0.2);
    EXPECT_EQ(data.module, i + 1);
  }
  EXPECT_EQ(arm_drive(6).limits.maximum_speed, 0.475);
  EXPECT_EQ(arm_drive(7).limits.maximum_speed, 0.475);
}

TEST(DriveData, ErrorsNameFileLineAndKey) {
  EXPECT_THAT(error_of("resistance_ohm: 0.6", "resistance_ohm: -0.6"),
              AllOf(HasSubstr("drives.yaml:"), HasSubstr("drives[0].motor.resistance_ohm")));
}

struct BadCase {
  const char* name;
  const char* what;
  const char* with;
  const char* says;

  friend void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.name; }
};

class BadDriveData : public testing::TestWithParam<BadCase> {};

TEST_P(BadDriveData, IsRefusedWithTheReason) {
  EXPECT_THAT(error_of(GetParam().what, GetParam().with), HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BadDriveData,
    testing::Values(
        BadCase{"UnknownKey", "ratio: 596", "ration: 596", "ration"},
        BadCase{"MissingKey", "current_limit_a: 9.5", "#", "current_limit_a"},
        BadCase{"WrongUnit", "backlash_rad: 1.5e-4", "backlash_m: 1.5e-4", "backlash_m"},
        BadCase{"UnknownSection", "encoder:", "encoders:", "encoders"},
        BadCase{"NotANumber", "ratio: 596", "ratio: many", "ratio"},
        BadCase{"Infinite", "ratio: 596", "ratio: .inf", "ratio"},
        BadCase{"NominalAboveLimit", "nominal_current_a: 5.7", "nominal_current_a: 10",
                "above current_limit_a"},
        BadCase{"ColdLimit", "maximum_winding_c: 120", "maximum_winding_c: 20", "above ambient_c"},
        BadCase{"WeakGear", "breaking_torque_nm: 1110", "breaking_torque_nm: 100", "below the rated peak"},
        BadCase{"HoldsLessThanItSlides", "backlash_rad: 1.5e-4",
                "dry_friction_nm: 9\n      static_friction_nm: 8", "is below dry_friction_nm"},
        BadCase{"NeverMoves", "backlash_rad: 1.5e-4", "dry_friction_nm: 9\n      static_friction_nm: 180",
                "the motor never moves"},
        BadCase{"SlidesTooHard", "backlash_rad: 1.5e-4", "dry_friction_nm: 110", "cannot reach"},
        BadCase{"LoopBetweenTicks", "integral_time_s: 0.08", "integral_time_s: 0.08, period_s: 0.0015",
                "whole number of ticks"},
        BadCase{"LoopFasterThanTicks", "integral_time_s: 0.08", "integral_time_s: 0.08, period_s: 0.0004",
                "whole number of ticks"},
        BadCase{"LoopTooSlowForItsGains", "integral_time_s: 0.08", "integral_time_s: 0.08, period_s: 0.02",
                "a loop that runs every 0.02"},
        BadCase{"RigidWithPlay", "stiffness_nm_per_rad: 60000", "#", "stiffness_nm_per_rad"},
        BadCase{"SoftBeyondHard", "soft_rad: [-3.093, 3.093]", "soft_rad: [-3.2, 3.093]",
                "reaches beyond hard_rad"},
        BadCase{"LimitsReversed", "soft_rad: [-3.093, 3.093]", "soft_rad: [3.093, -3.093]",
                "smaller, larger"},
        BadCase{"HomeOutside", "position_rad: 0", "position_rad: 3.12", "outside of the soft limits"},
        BadCase{"HomeTooFast", "speed_rad_per_s: 0.2", "speed_rad_per_s: 0.6", "above limits' speed"},
        BadCase{"SupplyReversed", "minimum_voltage_v: 22", "minimum_voltage_v: 25",
                "above nominal_voltage_v"},
        BadCase{"SupplyAboveThePorts", "nominal_voltage_v: 24", "nominal_voltage_v: 308", "at most 60"},
        BadCase{"FasterThanTheMotorCan", "speed_rad_per_s: 0.438", "speed_rad_per_s: 1.3", "cannot reach"},
        BadCase{"UnknownModule", "module: 1", "module: 32", "module"},
        BadCase{"ModuleTwice", "module: 2", "module: 1", "two drives have the module id 1"},
        BadCase{"JointTwice", "joints: [joint_2]", "joints: [joint_1]", "joint"},
        BadCase{"HalfAGripper", "[finger_left_joint, finger_right_joint]", "[finger_left_joint, thumb]",
                "not all"},
        BadCase{"HingeAndSlider", "joints: [joint_7]", "joints: [joint_7, finger_left_joint]", "alike"},
        BadCase{"NoJoint", "joints: [joint_7]", "joints: []", "must name 1 to 4 joints"},
        BadCase{"JointWithoutDrive", "joints: [joint_7]", "joints: [joint_8]",
                "no drive for the joint 'joint_7'"},
        BadCase{"FastIntegral", "integral_time_s: 0.08", "integral_time_s: -1", "integral_time_s"},
        BadCase{"NoSource", "source:", "sources:", "source"}),
    [](const auto& info) { return info.param.name; });

TEST(DriveData, OpenRavesSpeedOfTheWristIsRefusedWithTheReason) {
  std::string text = arm_file();
  const auto joint_6 = text.find("joints: [joint_6]");
  const auto at = text.find("speed_rad_per_s: 0.475", joint_6);
  EXPECT_THAT(error_of(text.substr(joint_6, at + 22 - joint_6),
                       text.substr(joint_6, at - joint_6) + "speed_rad_per_s: 0.873"),
              AllOf(HasSubstr("cannot reach the maximum speed"), HasSubstr("drives[5].limits")));
}

TEST(DriveData, GainsTooHighForTheTickAreRefused) {
  EXPECT_EQ(error_of("type: PRL120", "type: PRL120", 0.005), "");
  EXPECT_THAT(error_of("type: PRL120", "type: PRL120", 0.01), HasSubstr("Velocity Gain"));
}

// A drives file with this one entry, for one hinge.
drive::DriveData with_class(const std::string& entry, double speed = 2.0) {
  const test::TempFiles files;
  files.write("d.yaml", "source: test\ndrives:\n  - " + entry + "\n");
  hwparts::JointInfo joint{"elbow", false, -1.5, 2.5, 0.25};
  joint.maximum_speed = speed;
  const auto config =
      config::load_text("{name: a, kind: servo_group, drives: d.yaml}", "scene", files.folder());
  return servo_group::load_drives({"a", config, {joint}, 0.001}).drives.at(0).data;
}

std::string error_with_class(const std::string& entry) {
  try {
    with_class(entry);
    return "";
  } catch (const config::ConfigError& error) {
    return error.what();
  }
}

TEST(ServoClass, GivesAllThatAFileLeavesOut) {
  const auto data = with_class("{joints: [elbow], servo: 250W}");
  EXPECT_EQ(data.motor.torque_constant, 0.123);
  EXPECT_EQ(data.motor.nominal_current, 6.8);
  EXPECT_EQ(data.supply.nominal_voltage, 48);
  EXPECT_EQ(data.limits.maximum_speed, 2.0) << "the model's";
  EXPECT_EQ(data.limits.soft_minimum, -1.5);
  EXPECT_EQ(data.limits.hard_maximum, 2.5);
  EXPECT_NEAR(data.gear.ratio, 0.8 * 3670 * 2 * M_PI / 60 / 2.0, 1e-9) << "0.8 of the no-load speed";
  EXPECT_EQ(data.module, 1);
  EXPECT_FALSE(data.brake.present);
}

TEST(ServoClass, WhatAFileSaysReplacesIt) {
  const auto data = with_class(
      "{joints: [elbow], servo: 60W, module: 7, gear: {ratio: 160}, limits: {speed_rad_per_s: 1}, "
      "motor: {current_limit_a: 4}}");
  EXPECT_EQ(data.gear.ratio, 160);
  EXPECT_EQ(data.module, 7);
  EXPECT_EQ(data.motor.current_limit, 4);
  EXPECT_EQ(data.motor.nominal_current, 1.74) << "the rest of the section is the class'";
  EXPECT_EQ(data.limits.maximum_speed, 1);
  EXPECT_EQ(data.limits.hard_maximum, 2.5);
}

TEST(ServoClass, EveryOneOfTheCatalogueIsRight) {
  for (const auto& name : drive::servo_class_names()) {
    for (const double speed : {0.0, 0.1, 3.0, 20.0})
      EXPECT_GT(with_class("{joints: [elbow], servo: " + name + "}", speed).limits.maximum_speed, 0) << name;
    // The data sheets agree with themselves: nominal torque is nominal current less the no-load current.
    const auto& servo = *drive::find_servo_class(name);
    EXPECT_NEAR(servo.torque_constant * (servo.nominal_current - servo.no_load_current), servo.nominal_torque,
                0.02 * servo.nominal_torque);
    EXPECT_NEAR((servo.nominal_voltage - servo.resistance * servo.no_load_current) / servo.torque_constant,
                servo.no_load_speed, 0.02 * servo.no_load_speed);
  }
}

TEST(ServoClass, IsRefusedWhereItIsUnknownOrItsJointHasNoStops) {
  EXPECT_THAT(error_with_class("{joints: [elbow], servo: 200W}"),
              AllOf(HasSubstr("drives[0].servo"), HasSubstr("servo class '200W'"), HasSubstr("250W")));
}

TEST(DriveData, AllMissingKeysAreToldAtOnce) {
  const auto error = error_with_class("{joints: [elbow], motor: {resistance_ohm: 1}}");
  for (const char* key : {"type", "module", "motor.torque_constant_nm_per_a", "gear.ratio",
                          "encoder.increments_per_turn", "limits.speed_rad_per_s", "loop.position_gain_per_s",
                          "home.position_rad", "supply.nominal_voltage_v"})
    EXPECT_THAT(error, HasSubstr(key));
  EXPECT_THAT(error, AllOf(HasSubstr("missing: "), HasSubstr("servo: 60W or 250W")));
  EXPECT_EQ(error.find("resistance_ohm"), std::string::npos);
  EXPECT_EQ(error.find("stiffness"), std::string::npos) << "has a value of its own";
}

TEST(DriveList, RefusesFingersThatStartApartAndAStartBeyondAHardLimit) {
  auto context = arm_context();
  context.joints[8].initial_position = 0.02;
  EXPECT_THROW(servo_group::load_drives(context), config::ConfigError);
  context = arm_context();
  context.joints[1].initial_position = 2.5;
  EXPECT_THROW(servo_group::load_drives(context), config::ConfigError);
}

TEST(DriveList, RefusesAPartWithoutJointsAndAFileThatIsNotThere) {
  auto context = arm_context();
  context.joints.clear();
  EXPECT_THROW(servo_group::load_drives(context), config::ConfigError);
  context = arm_context();
  context.config = config::load_text("{name: arm, drives: nowhere.yaml}", "scene", VISUM_SOURCE_DIR);
  EXPECT_THROW(servo_group::load_drives(context), config::ConfigError);
}

servo_group::PartOptions options(const std::string& more) {
  return servo_group::read_options(
      config::load_text("{name: arm, kind: amtec_arm, drives: d.yaml" + more + "}", "scene"));
}

TEST(PartOptions, HaveTheirDefaults) {
  EXPECT_EQ(options("").on_controller_lost, servo_group::OnControllerLost::kStop);
  EXPECT_TRUE(options("").homed);
  EXPECT_TRUE(options("").execution_enable);
}

TEST(PartOptions, AreRead) {
  const auto read =
      options(", model: arm, joints: [a], on_controller_lost: hold, homed: false, execution_enable: false");
  EXPECT_EQ(read.on_controller_lost, servo_group::OnControllerLost::kHold);
  EXPECT_FALSE(read.homed);
  EXPECT_FALSE(read.execution_enable);
}

TEST(PartOptions, RefuseWhatTheyDoNotKnow) {
  EXPECT_THROW(options(", on_controller_lost: freeze"), config::ConfigError);
  EXPECT_THROW(options(", homed: maybe"), config::ConfigError);
  EXPECT_THROW(options(", execution_enable: 2"), config::ConfigError);
  EXPECT_THROW(options(", homd: true"), config::ConfigError);
}

}  // namespace
}  // namespace visum::test
