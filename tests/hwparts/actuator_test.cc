// Ideal joints with `actuators`: modes, their laws, and changes from one to another.
#include <gtest/gtest.h>

#include <cmath>

#include "hwparts/ideal_joints/ideal_joints.h"
#include "hwparts/kinds/part_kinds.h"

namespace visum::ideal_joints {
namespace {

constexpr double kTick = 0.001;

// Places of the inputs of a part with one joint.
enum Input { kAngle, kSpeed, kEffort, kStiffness, kDamping, kMode };

hwparts::PartContext switchable(const std::string& actuators) {
  hwparts::JointInfo joint{"elbow", false, -2.0, 2.0, 0.5};
  joint.maximum_speed = 4;
  joint.maximum_effort = 10;
  return {"robot",
          config::load_text("{name: robot, kind: ideal_joints, actuators: " + actuators + "}", "scene"),
          {joint},
          kTick};
}

// A joint with an inertia of 0.1 kg·m² and a load, moved by the part.
struct Bench {
  explicit Bench(const std::string& actuators)
      : part(hwparts::make_part("ideal_joints", switchable(actuators))) {
    for (const auto& port : part->description().controller_inputs) inputs.push_back(port.initial);
  }
  // The law of hwparts/joint.h, implicit in the velocity at the end of the tick.
  void tick() {
    std::vector<hwparts::JointDrive> drives(1);
    part->act(inputs, {&sample, 1}, drives);
    drive = drives[0];
    const double h = kTick / inertia;
    const double free = sample.velocity + h * (load + drive.feedforward);
    double effort = (drive.target_velocity - free) / (drive.compliance + h);
    effort = std::clamp(effort, -drive.max_effort, drive.max_effort);
    sample.velocity = free + h * effort;
    sample.position += kTick * sample.velocity;
    sample.effort = effort + drive.feedforward;
    part->publish({&sample, 1}, outputs);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }
  void set_mode(Mode mode) { inputs[kMode] = static_cast<double>(mode); }

  std::unique_ptr<hwparts::Part> part;
  std::vector<double> inputs, outputs = std::vector<double>(3);
  hwparts::JointSample sample{0.5, 0, 0};
  hwparts::JointDrive drive;
  double inertia = 0.1, load = 0.0;
};

TEST(Actuator, TheSceneChoosesModeAndGains) {
  const Bench bench("{each: {kp: 30}, elbow: {mode: impedance, kd: 2}}");
  const auto& ports = bench.part->description().controller_inputs;
  ASSERT_EQ(ports.size(), 6u);
  EXPECT_EQ(ports[kMode].name, "Mode 1");
  EXPECT_EQ(ports[kMode].initial, 3);
  EXPECT_EQ(protocol::in_words(ports[kMode], 3), "impedance");
  EXPECT_EQ(ports[kStiffness].initial, 30);
  EXPECT_EQ(ports[kDamping].initial, 2);
}

TEST(Actuator, AnImpedanceIsASpringAndADamper) {
  Bench bench("{each: {mode: impedance, kp: 50, kd: 3}}");
  bench.load = -2.0;
  bench.run(5000);
  EXPECT_NEAR(bench.sample.position, 0.5 - 2.0 / 50.0, 1e-6) << "the load over the stiffness";
  bench.inputs[kEffort] = 2.0;
  bench.run(5000);
  EXPECT_NEAR(bench.sample.position, 0.5, 1e-6) << "the feed-forward carries the load";
  bench.inputs[kSpeed] = 0.1;
  bench.tick();
  EXPECT_NEAR(bench.sample.effort, 2.0 + 3.0 * (0.1 - bench.sample.velocity), 0.01);
}

TEST(Actuator, AnImpedanceStaysStableAtAnyGains) {
  Bench bench("{each: {mode: impedance, kp: 1e7, kd: 0}}");
  bench.inertia = 1e-3;
  bench.sample.position = 0.50001;
  bench.run(2000);
  EXPECT_NEAR(bench.sample.position, 0.5, 1e-6);
}

TEST(Actuator, AVelocityIsKept) {
  Bench bench("{each: {mode: velocity}}");
  bench.inputs[kSpeed] = -0.5;
  bench.run(1000);
  EXPECT_NEAR(bench.sample.velocity, -0.5, 1e-9);
  bench.inputs[kSpeed] = 100;
  bench.run(1000);
  EXPECT_NEAR(bench.sample.velocity, 4, 1e-9) << "the model's speed";
}

TEST(Actuator, AnEffortIsGivenWithinTheModelsLimits) {
  Bench bench("{each: {mode: effort}}");
  bench.inputs[kEffort] = -3;
  bench.tick();
  EXPECT_DOUBLE_EQ(bench.sample.effort, -3);
  bench.inputs[kEffort] = 50;
  bench.tick();
  EXPECT_DOUBLE_EQ(bench.sample.effort, 10);
  bench.run(1000);
  EXPECT_NEAR(bench.sample.velocity, 4, 1e-9) << "it gets no faster";
  bench.inputs[kEffort] = 0;
  bench.tick();
  EXPECT_EQ(bench.sample.effort, 0);
}

TEST(Actuator, AnImpedanceKeepsToTheModelsLimits) {
  Bench bench("{each: {mode: impedance, kp: 1000, kd: 1}}");
  bench.inputs[kAngle] = 2;
  double fastest = 0, hardest = 0;
  for (int i = 0; i < 2000; ++i) {
    bench.tick();
    fastest = std::max(fastest, std::abs(bench.sample.velocity));
    hardest = std::max(hardest, std::abs(bench.sample.effort));
  }
  EXPECT_LE(fastest, 4.0 + 0.1 + 1e-9) << "one tick of full effort above it";
  EXPECT_GT(fastest, 3.9);
  EXPECT_LE(hardest, 10.0 + 1e-9);
  EXPECT_NEAR(bench.sample.position, 2, 1e-3);
}

// Every change of the mode, with stale targets far away, under load: nothing jumps.
class Switch : public testing::TestWithParam<std::pair<Mode, Mode>> {};

TEST_P(Switch, StartsFromWhereTheJointIs) {
  const auto [from, to] = GetParam();
  Bench bench("{each: {kp: 100, kd: 5}}");
  bench.load = -1.5;
  bench.run(500);  // holds the load in mode position
  bench.set_mode(from);
  bench.run(500);
  const auto before = bench.sample;
  bench.inputs[kAngle] = -1.5;  // targets of the mode before that nobody means any more
  bench.inputs[kSpeed] = 2;
  bench.inputs[kEffort] = -9;
  if (from != to) {  // they were there before the change
    bench.run(1);
    bench.sample = before;
  }
  bench.set_mode(to);
  bench.tick();
  EXPECT_NEAR(bench.sample.effort, before.effort, 1e-3);
  bench.run(300);
  EXPECT_NEAR(bench.sample.position, before.position, 1e-3) << "holds until a target of it changes";
  EXPECT_NEAR(bench.sample.effort, 1.5, 1e-2);
  // A new value is followed at once.
  bench.inputs[kAngle] = -1.4;
  bench.inputs[kSpeed] = 1.9;
  bench.inputs[kEffort] = -8;
  bench.run(300);
  EXPECT_GT(std::abs(bench.sample.position - before.position), 0.2);
}

std::vector<std::pair<Mode, Mode>> changes() {
  std::vector<std::pair<Mode, Mode>> all;
  for (std::size_t a = 0; a < kModes; ++a)
    for (std::size_t b = 0; b < kModes; ++b)
      if (a != b) all.emplace_back(static_cast<Mode>(a), static_cast<Mode>(b));
  return all;
}

INSTANTIATE_TEST_SUITE_P(EveryChange, Switch, testing::ValuesIn(changes()), [](const auto& info) {
  return std::string(kModeNames[static_cast<int>(info.param.first)]) + "To" +
         kModeNames[static_cast<int>(info.param.second)];
});

TEST(Actuator, ATargetInTheSameWriteAsTheModeIsFollowed) {
  Bench bench("{each: {mode: effort}}");
  bench.run(10);
  bench.set_mode(Mode::kPosition);
  bench.inputs[kAngle] = 1.0;
  bench.run(2000);
  EXPECT_NEAR(bench.sample.position, 1.0, 1e-6);
}

TEST(Actuator, AMovingJointGoesOnAtItsSpeedInModeVelocity) {
  Bench bench("{each: {mode: position}}");
  bench.inputs[kAngle] = -2;
  bench.run(100);
  const double speed = bench.sample.velocity;
  bench.set_mode(Mode::kVelocity);
  bench.run(100);
  EXPECT_EQ(speed, -4);
  EXPECT_NEAR(bench.sample.velocity, speed, 1e-9);
}

TEST(Actuator, ALostControllerLeavesNoJointRunning) {
  for (const char* mode : {"velocity", "effort"}) {
    Bench bench(std::string("{each: {mode: ") + mode + "}}");
    bench.inputs[kSpeed] = 1;
    bench.inputs[kEffort] = 1;
    bench.run(20);
    bench.part->controller_lost();
    bench.run(2000);
    const double stood = bench.sample.position;
    bench.run(500);
    EXPECT_NEAR(bench.sample.position, stood, 1e-9) << mode;
    bench.inputs[kSpeed] = 0.5;
    bench.inputs[kEffort] = 0.5;
    bench.run(100);
    EXPECT_GT(bench.sample.position, stood + 0.01) << mode << ": a new target is followed";
  }
}

TEST(Actuator, ASnapshotHoldsAChangeOfTheMode) {
  Bench bench("{each: {kp: 100, kd: 5}}");
  bench.load = -1.5;
  bench.run(100);
  bench.set_mode(Mode::kImpedance);
  bench.run(10);
  std::vector<std::byte> bytes;
  {
    hwparts::StateWriter writer(bytes);
    bench.part->save(writer);
  }
  Bench other("{each: {kp: 100, kd: 5}}");
  hwparts::StateReader reader(bytes);
  other.part->load(reader);
  EXPECT_TRUE(reader.at_end());
  other.inputs = bench.inputs;
  other.sample = bench.sample;
  other.load = bench.load;
  bench.run(50);
  other.run(50);
  EXPECT_EQ(bench.sample.position, other.sample.position);
  EXPECT_EQ(bench.sample.effort, other.sample.effort);
}

TEST(Actuator, AModeIsAWholeNumber) {
  Bench bench("{}");
  EXPECT_FALSE(bench.part->refuse(bench.inputs));
  bench.inputs[kMode] = 1.5;
  const auto reason = bench.part->refuse(bench.inputs);
  ASSERT_TRUE(reason);
  EXPECT_EQ(reason->find("Mode 1 takes whole numbers only"), 0u) << *reason;
}

}  // namespace
}  // namespace visum::ideal_joints
