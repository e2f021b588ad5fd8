// Sensors and parts of a plug-in's kinds.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/plugin/plugged_scene.h"

namespace visum {
namespace {

using test::output_of;
using test::part_of;
using test::run;

scene::Scene kinds_scene(const std::string& yaml) {
  return test::scene_of("plugins: [kinds]\n" + yaml);
}

// A rod of 1 kg and 0.02 kg·m² about the hinge, which lies in its centre of mass, so that gravity does not
// turn it.
const std::string kRotor = R"(
bodies: [{name: rotor, mass: 1, inertia: [0.02, 0.02, 0.02, 0, 0, 0]}]
joints: [{name: hinge, type: hinge, child: rotor, axis: [1, 0, 0]}]
)";

TEST(PluggedSensor, MeasuresTheWorldAndIsDisturbedAsOthersAre) {
  cycle::Simulation simulation(kinds_scene(R"(
bodies: [{name: ramp, fixed: true, pose: {rpy: [0.3, 0, 0]}}]
sensors:
  - {name: fine, kind: tilt, body: ramp}
  - {name: coarse, kind: tilt, body: ramp, resolution: 0.25, rate_hz: 100}
)"));
  run(simulation, 20);
  EXPECT_NEAR(output_of(simulation, "fine", "Tilt"), 0.3, 1e-12);
  EXPECT_EQ(output_of(simulation, "fine", "Changed"), 20.0);
  EXPECT_EQ(output_of(simulation, "coarse", "Tilt"), 0.25);
  EXPECT_EQ(output_of(simulation, "coarse", "Changed"), 2.0);
}

TEST(PluggedSensor, CastsRaysPastTheBodyThatCarriesIt) {
  cycle::Simulation simulation(kinds_scene(R"(
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: lamp, fixed: true, pose: {xyz: [0, 0, 1.5]}, shapes: [{sphere: 0.1}]}
sensors: [{name: height, kind: height, body: lamp}]
)"));
  run(simulation, 1);
  EXPECT_NEAR(output_of(simulation, "height", "Height"), 1.5, 1e-12);
}

TEST(PluggedSensor, ThatThrowsIsOffAndTheWorldGoesOn) {
  cycle::Simulation simulation(kinds_scene(R"(
bodies: [{name: ramp, fixed: true}]
sensors: [{name: tilt, kind: tilt, body: ramp, throws: true}, {name: height, kind: height, rays: false}]
)"));
  run(simulation, 50);
  EXPECT_EQ(output_of(simulation, "tilt", "Changed"), 5.0);
  EXPECT_EQ(*part_of(simulation, "tilt").part->node_fault(), "the bubble has burst");
  EXPECT_EQ(output_of(simulation, "height", "Changed"), 0.0);
  EXPECT_EQ(*part_of(simulation, "height").part->node_fault(),
            "asks for a distance, and did not say that it wants rays");
  EXPECT_FALSE(simulation.frozen());
}

TEST(PluggedSensor, ThatFailsIsOffWhateverFaultActs) {
  for (const char* fault : {"sensor_wrong", "sensor_intermittent", "sensor_slow"}) {
    for (const char* fails : {"throws", "nan"}) {
      SCOPED_TRACE(std::string(fault) + ", " + fails);
      cycle::Simulation simulation(
          kinds_scene("bodies: [{name: ramp, fixed: true}]\n"
                      "sensors: [{name: tilt, kind: tilt, body: ramp, " +
                      std::string(fails) + ": true}]"));
      std::string why;
      const auto made = hwparts::make_fault(fault, {}, why);
      ASSERT_TRUE(made) << why;
      ASSERT_TRUE(simulation.inject({0, *made, 1000}).done());
      run(simulation, 50);
      EXPECT_LE(output_of(simulation, "tilt", "Changed"), 5.0);
      EXPECT_TRUE(std::isfinite(output_of(simulation, "tilt", "Tilt")));
      EXPECT_NE(*part_of(simulation, "tilt").part->node_fault(), "");
    }
  }
}

TEST(PluggedPart, DrivesItsJoints) {
  cycle::Simulation simulation(kinds_scene(kRotor + "parts: [{name: motor, kind: motor, joints: [hinge]}]"));
  simulation.write_inputs(0, 0, std::vector{0.02});
  run(simulation, 1000);
  // 0.02 N·m on 0.02 kg·m² for a second: 1/2 rad, up to the error of half a tick.
  EXPECT_NEAR(output_of(simulation, "motor", "Angle hinge"), 0.5, 1e-3);
  EXPECT_EQ(output_of(simulation, "motor", "Node State"), 0.0);
}

TEST(PluggedPart, GroupsItsPorts) {
  cycle::Simulation simulation(kinds_scene(kRotor + "parts: [{name: motor, kind: motor, joints: [hinge]}]"));
  const auto& description = part_of(simulation, "motor").part->description();
  EXPECT_EQ(description.controller_inputs.at(0).group, "Torque");
  EXPECT_EQ(description.sensor_outputs.at(0).group, "Angle");
  EXPECT_EQ(description.sensor_outputs.back().group, "") << "of its own: Node State";
}

TEST(PluggedPart, ThatAsksForNonsenseLetsGoOfItsJoints) {
  cycle::Simulation simulation(
      kinds_scene(kRotor + "parts: [{name: motor, kind: motor, joints: [hinge], fails: act}]"));
  simulation.write_inputs(0, 0, std::vector{6.0});
  run(simulation, 100);
  EXPECT_EQ(*part_of(simulation, "motor").part->node_fault(), "drives a joint by what is no finite number");
  EXPECT_EQ(output_of(simulation, "motor", "Node State"), 1.0);
  EXPECT_EQ(simulation.state().joints[0].position, 0.0);
  EXPECT_FALSE(simulation.frozen());
}

TEST(PluggedPart, KeepsItsOutputsWhereItPublishesNonsense) {
  cycle::Simulation simulation(
      kinds_scene(kRotor + "parts: [{name: motor, kind: motor, joints: [hinge], fails: publish}]"));
  run(simulation, 10);
  EXPECT_EQ(*part_of(simulation, "motor").part->node_fault(),
            "'Angle hinge' must be within -1000000.000000 and 1000000.000000, is 1000000000.000000");
  EXPECT_EQ(output_of(simulation, "motor", "Angle hinge"), 0.0);
}

TEST(PluggedPart, IsTakenBackAndResetAsOthersAre) {
  cycle::Simulation simulation(kinds_scene(kRotor + "parts: [{name: motor, kind: motor, joints: [hinge]}]"));
  const auto first = simulation.state_hash();
  simulation.write_inputs(0, 0, std::vector{1.0});
  run(simulation, 30);
  const auto snapshot = simulation.take_snapshot();
  run(simulation, 30);
  const auto later = simulation.state_hash();
  ASSERT_TRUE(simulation.restore_snapshot(snapshot).done());
  run(simulation, 30);
  EXPECT_EQ(simulation.state_hash(), later);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), first);
}

}  // namespace
}  // namespace visum
