// A world of two bodies, two joints and one part, as plain values: what scenario pieces are tried on.
#pragma once

#include "clients/visum/run/quantity.h"

namespace visum::run {

inline Catalogue small_catalogue() {
  Catalogue catalogue;
  catalogue.world.tick_ns = 1'000'000;
  protocol::BodyDescription box, table;
  box.name = "box";
  table.name = "table";
  catalogue.world.bodies = {box, table};
  protocol::JointDescription hinge, slider;
  hinge.name = "arm/joint_1";
  hinge.type = "hinge";
  hinge.part = "arm";
  slider.name = "arm/finger";
  slider.type = "slider";
  slider.part = "arm";
  catalogue.world.joints = {hinge, slider};
  protocol::PartDescription arm;
  arm.name = "arm";
  arm.controller_inputs = {{"Desired Angle 1", "rad", -6, 6, 0, "Desired Angle"},
                           {"Halt", "", 0, 1e6, 0, ""}};
  arm.sensor_outputs = {{"Actual Angle 1", "rad", -7, 7, 0, "Actual Angle"},
                        {"Module State 1", "", 0, 4294967295.0, 0, ""}};
  arm.parameters = {{"gain", "", "", 1.0, 0.0, 2.0, {}, false}};
  catalogue.parts["arm"] = arm;
  catalogue.faults["arm"] = {{"encoder_stuck", "drive", "", {{"joint", "", 1, 64, true, 0}}}};
  return catalogue;
}

// The box stands upright at (1, 2, 3), the table at the origin; nothing moves, nothing touches.
inline Observation small_observation(double time_s = 0.0) {
  Observation now;
  now.world.sim_time_ns = static_cast<std::int64_t>(time_s * 1e9 + 0.5);
  now.world.tick = now.world.sim_time_ns / 1'000'000;
  now.world.poses = {1, 2, 3, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0};
  now.world.velocities.assign(12, 0.0);
  now.world.joint_positions = {0.25, 0.01};
  now.world.joint_velocities = {0.5, -0.02};
  now.world.joint_efforts = {3.0, -4.0};
  now.world.peak_following_errors = {0.003, 0.001};
  now.world.peak_contact_forces = {12.5, 0.0};
  protocol::PartSample sample;
  sample.part = "arm";
  sample.controller_inputs = {0.3, 2.0};
  sample.sensor_outputs = {0.25, 6.0};
  now.parts["arm"] = sample;
  return now;
}

// Beside the two a pillar, which stands fixed on a cell of the floor.
inline Catalogue pillar_catalogue() {
  Catalogue catalogue = small_catalogue();
  protocol::ShapeDescription block;
  block.kind = "box";
  block.size = {1, 1, 2};
  block.pose = {0, 0, 0, 1, 0, 0, 0};
  protocol::BodyDescription pillar;
  pillar.name = "pillar";
  pillar.fixed = true;
  pillar.shapes = {block};
  catalogue.world.bodies.push_back(pillar);
  return catalogue;
}

inline Observation pillar_observation(double time_s) {
  Observation now = small_observation(time_s);
  now.world.poses.insert(now.world.poses.end(), {3.5, 3.5, 0, 1, 0, 0, 0});
  return now;
}

// The table, the second body, goes.
inline void remove_table(Catalogue& catalogue) {
  catalogue.world.bodies.erase(catalogue.world.bodies.begin() + 1);
}
inline void remove_table(Observation& now) {
  now.world.poses.erase(now.world.poses.begin() + 7, now.world.poses.begin() + 14);
}

// 16 cells, on one of which the pillar stands; from (1, 2) and from (3, 2) four are near.
inline constexpr const char* kPillarFloor =
    "coverage: {body: box, within: 1, from: [0, 0], to: [4, 4], cell: 1}";

}  // namespace visum::run
