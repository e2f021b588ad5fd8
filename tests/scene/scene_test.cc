#include "server/scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "protocol/config/trig.h"
#include "server/scene/values.h"
#include "server/world/world_state.h"
#include "tests/scene/data_folder.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using world::JointKind;
using world::ShapeKind;

const Scene& complete() {
  static const Scene scene = load_scene(kData / "complete.yaml");
  return scene;
}

const world::Body& body(const std::string& name) {
  const world::BodyId id = complete().world.find_body(name);
  if (!id.valid()) throw std::runtime_error("no body " + name);
  return complete().world.bodies[id.index()];
}

std::vector<world::Shape> shapes_of(const Scene& scene, const std::string& name) {
  std::vector<world::Shape> shapes;
  for (const world::Shape& shape : scene.world.shapes)
    if (shape.body == scene.world.find_body(name)) shapes.push_back(shape);
  return shapes;
}

Scene load_text(const std::string& yaml) {
  const test::TempFiles files;
  return load_scene(files.write("scene.yaml", yaml));
}

TEST(Scene, ACompleteSceneIsFreeOfFaults) {
  EXPECT_EQ(world::find_fault(complete().world), "");
}

TEST(Scene, SettingsOfAnIncludedFileHoldUntilSetAgain) {
  const Scene& scene = complete();
  EXPECT_EQ(scene.name, "cell");
  EXPECT_EQ(scene.world.name, "cell");
  EXPECT_EQ(scene.seed, 1u);
  EXPECT_EQ(scene.world.gravity, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_EQ(scene.world.surfaces[0].friction, 0.8);
  EXPECT_TRUE(body("floor").fixed);
  EXPECT_EQ(load_text("visum: 1\ninclude: [" + (kData / "room.yaml").string() + "]").world.gravity[2], -1.62);
}

TEST(Scene, SettingsHaveTheDocumentedDefaults) {
  const Scene scene = load_text("visum: 1");
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.world.tick_ns, 1'000'000);
  EXPECT_EQ(scene.world.gravity, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_EQ(scene.clock, ClockKind::kRealtime);
  EXPECT_EQ(scene.speed, 1.0);
  EXPECT_EQ(scene.seed, 1u);
  EXPECT_EQ(scene.lockstep_timeout_ns, 10'000'000'000);
  ASSERT_EQ(scene.world.engines.size(), 1u);
  EXPECT_EQ(scene.world.engines[0].name, "impulse");
  EXPECT_EQ(scene.world.surfaces[0].friction, 0.8);
}

TEST(Scene, SettingsAreRead) {
  const Scene scene = load_text(
      "{visum: 1, name: n, tick_ms: 0.1, clock: lockstep, speed: 2.5, seed: 7, lockstep_timeout_s: 0.5, "
      "gravity: [1, 2, 3]}");
  EXPECT_EQ(scene.world.tick_ns, 100'000);
  EXPECT_EQ(scene.clock, ClockKind::kLockstep);
  EXPECT_EQ(scene.speed, 2.5);
  EXPECT_EQ(scene.seed, 7u);
  EXPECT_EQ(scene.lockstep_timeout_ns, 500'000'000);
  EXPECT_EQ(scene.world.gravity, Eigen::Vector3d(1, 2, 3));
}

TEST(Scene, TheCollisionStageHasAShortAndALongForm) {
  using enum world::CollisionKind;
  EXPECT_EQ(load_text("visum: 1").world.collision_stage, kVisum);
  EXPECT_EQ(load_text("{visum: 1, collision: fcl}").world.collision_stage, kFcl);
  const Scene scene = load_text("{visum: 1, collision: {stage: fcl, continuous: false, work_limit: 9}}");
  EXPECT_EQ(scene.world.collision_stage, kFcl);
  EXPECT_FALSE(scene.world.continuous_collision);
  EXPECT_EQ(scene.world.collision_work_limit, 9u);
  EXPECT_EQ(load_text("{visum: 1, collision: {stage: visum}}").world.collision_stage, kVisum);
}

TEST(Scene, TheEnginesAndTheSurfacesSettingsAreRead) {
  const Scene scene = load_text(
      "{visum: 1, engine: {kind: impulse, solver: iterate, budget: 3, v_max: 0.01, sleep: 0.5}, "
      "surfaces: {felt: {rolling_friction: 0.01, torsional_friction: 0.002}}}");
  EXPECT_EQ(scene.world.engines[0].solver, "iterate");
  EXPECT_EQ(scene.world.engines[0].budget, 3);
  EXPECT_EQ(scene.world.engines[0].v_max, 0.01);
  EXPECT_EQ(scene.world.engines[0].sleep_s, 0.5);
  ASSERT_EQ(scene.world.surfaces.size(), 2u);
  EXPECT_EQ(scene.world.surfaces[0].rolling_friction, 0.0);
  EXPECT_EQ(scene.world.surfaces[1].rolling_friction, 0.01);
  EXPECT_EQ(scene.world.surfaces[1].torsional_friction, 0.002);
}

TEST(Scene, BodiesChooseTheirEngineByName) {
  const Scene& scene = complete();
  ASSERT_EQ(scene.world.engines.size(), 2u);
  EXPECT_EQ(scene.engine_names, (std::vector<std::string>{"default", "fast"}));
  EXPECT_EQ(scene.world.engines[1].step, "quick");
  EXPECT_EQ(body("ball").engine, 1);
  EXPECT_EQ(body("wedge").engine, 0);
}

TEST(Scene, TheEngineOptionReplacesEveryEngine) {
  const Scene scene = load_scene(kData / "complete.yaml", {"other"});
  EXPECT_EQ(scene.world.engines[0].name, "other");
  EXPECT_EQ(scene.world.engines[1].name, "other");
  EXPECT_EQ(scene.world.engines[1].step, "quick");
}

TEST(Scene, MassAndInertiaComeFromTheShapes) {
  const world::Body& ball = body("ball");
  const double mass = 500 * 4.0 / 3.0 * std::numbers::pi * 0.05 * 0.05 * 0.05;
  EXPECT_NEAR(ball.mass_kg, mass, 1e-12);
  EXPECT_NEAR(ball.inertia_C(0, 0), 0.4 * mass * 0.0025, 1e-15);
  EXPECT_EQ(ball.v_WB, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(ball.w_WB, Eigen::Vector3d(0, 0.5, 0));
  // The wedge's centre of mass lies at a third, half and a third of its box. The cylinder is only a visual.
  const world::Body& wedge = body("wedge");
  EXPECT_NEAR(wedge.mass_kg, 0.3, 1e-12);
  EXPECT_TRUE(wedge.p_BC.isApprox(Eigen::Vector3d(0.1 / 3, 0.05, 0.1 / 3)));
}

TEST(Scene, GivenInertiaIsTakenAsItIs) {
  const world::Body& crate = body("crate");
  EXPECT_EQ(crate.mass_kg, 2);
  EXPECT_EQ(crate.p_BC, Eigen::Vector3d(0, 0, -0.05));
  EXPECT_EQ(crate.inertia_C(2, 2), 0.03);
  const Scene scene =
      load_text("{visum: 1, bodies: [{name: a, mass: 1, inertia: [3, 4, 5, 0.1, 0.2, 0.3]}]}");
  EXPECT_EQ(scene.world.bodies[0].inertia_C(0, 1), 0.1);
  EXPECT_EQ(scene.world.bodies[0].inertia_C(2, 0), 0.2);
  EXPECT_EQ(scene.world.bodies[0].inertia_C(1, 2), 0.3);
}

TEST(Scene, EveryKindOfShapeIsRead) {
  const Scene scene = load_text(
      "visum: 1\nbodies:\n- name: a\n  fixed: true\n  color: [0.1, 0.2, 0.3, 0.4]\n  shapes:\n"
      "  - {box: [1, 2, 3]}\n  - {sphere: 4}\n  - {sphere: {radius: 5}}\n  - {cylinder: {radius: 6, length: "
      "7}}\n"
      "  - {capsule: {radius: 8, length: 9}}\n  - {plane: true, color: [1, 1, 1], name: ground}\n"
      "  - {convex: '" +
      (kData / "wedge.obj").string() + "'}\n  - {mesh: '" + (kData / "wedge.obj").string() +
      "', scale: -2}\n");
  const auto& shapes = scene.world.shapes;
  ASSERT_EQ(shapes.size(), 8u);
  EXPECT_THAT(shapes[0].size, ElementsAre(1, 2, 3));
  EXPECT_EQ(shapes[1].size[0], 4);
  EXPECT_EQ(shapes[2].size[0], 5);
  EXPECT_THAT(shapes[3].size, ElementsAre(6, 7, 0));
  EXPECT_THAT(shapes[4].size, ElementsAre(8, 9, 0));
  EXPECT_EQ(shapes[5].kind, ShapeKind::kPlane);
  EXPECT_EQ(shapes[5].name, "ground");
  EXPECT_THAT(shapes[5].color, ElementsAre(1, 1, 1, 1));
  EXPECT_EQ(shapes[6].kind, ShapeKind::kConvex);
  EXPECT_EQ(shapes[6].name, "convex_6");
  EXPECT_THAT(shapes[0].color, ElementsAre(0.1, 0.2, 0.3, 0.4));
  ASSERT_EQ(scene.world.meshes.size(), 2u);
  EXPECT_EQ(scene.world.meshes[1].vertices[1], -2 * scene.world.meshes[0].vertices[1]);
  EXPECT_EQ(scene.world.meshes[1].triangles[0][1], scene.world.meshes[0].triangles[0][2])
      << "mirrored: turned round";
}

TEST(Scene, AMeshIsReadOncePerScale) {
  const std::string mesh = "mesh: '" + (kData / "wedge.obj").string() + "'";
  const Scene scene = load_text("visum: 1\nbodies: [{name: a, fixed: true, shapes: [{" + mesh + "}, {" +
                                mesh + "}, {" + mesh + ", scale: 2}]}]");
  EXPECT_EQ(scene.world.meshes.size(), 2u);
  EXPECT_EQ(scene.world.shapes[0].mesh, scene.world.shapes[1].mesh);
}

TEST(Scene, PosesTurnLikeUrdf) {
  const Scene scene = load_text(
      "{visum: 1, bodies: [{name: a, fixed: true, pose: {rpy: [0.1, 0.2, 0.3]}},"
      " {name: b, fixed: true, pose: {xyz: [1, 2, 3], wxyz: [0.7071, 0, 0, 0.7071]}}]}");
  const Eigen::Matrix3d R = scene.world.bodies[0].X_WB.q.toRotationMatrix();
  EXPECT_NEAR(R(2, 0), -std::sin(0.2), 1e-15);
  EXPECT_NEAR(R(2, 1), std::cos(0.2) * std::sin(0.1), 1e-15);
  EXPECT_NEAR(R(1, 0), std::sin(0.3) * std::cos(0.2), 1e-15);
  EXPECT_NEAR(scene.world.bodies[1].X_WB.q.norm(), 1.0, 1e-15);
  EXPECT_EQ(scene.world.bodies[1].X_WB.p, Eigen::Vector3d(1, 2, 3));
}

TEST(Scene, JointsAreTheSameFrameFromBothSides) {
  const auto& world = complete().world;
  const world::Joint& hinge = world.joints[world.find_joint("hinge").index()];
  EXPECT_EQ(hinge.kind, JointKind::kHinge);
  EXPECT_TRUE(hinge.limited);
  EXPECT_EQ(hinge.upper, 1.5);
  EXPECT_EQ(hinge.friction, 0.01);
  EXPECT_EQ(hinge.damping, 0.02);
  EXPECT_EQ(hinge.stop_restitution, 0.1);
  EXPECT_EQ(hinge.initial_position, 0.2);
  const world::Pose from_parent = body("crate").X_WB * hinge.X_PJ, from_child = body("lid").X_WB * hinge.X_CJ;
  EXPECT_TRUE(from_parent.p.isApprox(Eigen::Vector3d(1.5, 0.1, 0.5)));
  EXPECT_TRUE(from_parent.p.isApprox(from_child.p));
  EXPECT_NEAR(from_parent.q.angularDistance(from_child.q), 0, 1e-9);
}

// The C library's sines differ between processors. These use only operations that IEEE 754 fixes.
TEST(Scene, AnglesHaveTheSameBitsOnEveryProcessor) {
  for (int i = -2000; i <= 2000; ++i) {
    const double angle = 1e-3 * i;
    const config::SinCos half = config::sin_cos(0.5 * angle);
    const Eigen::Quaterniond roll = quaternion_from_rpy({angle, 0, 0});
    ASSERT_EQ(roll.x(), half.sin) << angle;
    ASSERT_EQ(roll.w(), half.cos) << angle;
    world::WorldModel model;
    model.bodies.resize(1);
    model.joints.push_back({.name = "hinge", .child = {0}, .initial_position = angle});
    const auto turned = world::initial_state(model).bodies[0].q_WB;
    const world::Pose still, hinge{Eigen::Vector3d::Zero(), {half.cos, 0, 0, half.sin}};
    const auto expected = (still * hinge * (still.inverse() * still)).q.normalized();
    ASSERT_EQ(turned.z(), expected.z()) << angle;
    ASSERT_EQ(turned.w(), expected.w()) << angle;
  }
}

TEST(Scene, EveryKindOfJointIsRead) {
  const Scene scene = load_text(
      "visum: 1\nbodies: [{name: a, mass: 1, shapes: [{sphere: 1}]}, {name: b, mass: 1, pose: {xyz: [0, 0, "
      "1]},"
      " shapes: [{sphere: 1}]}]\njoints:\n"
      "- {name: ball, type: ball, child: a}\n"
      "- {name: universal, type: universal, child: b, axis: [0, 0, 2], axis2: [0, 3, 0]}\n"
      "- {name: cylindrical, type: cylindrical, child: b, axis: [1, 0, 0]}\n"
      "- {name: screw, type: screw, child: b, axis: [1, 0, 0], pitch: -0.005, limits: [0, 9], position: 2}\n"
      "- {name: plane, type: point_on_plane, child: b, axis: [0, 1, 0]}\n"
      "- {name: line, type: point_on_line, child: b, axis: [0, 1, 0]}\n"
      "- {name: curve, type: point_on_curve, child: b, closed: true, points: [[0, 0, 0], [1, 0, 0], [1, 1, "
      "0]]}\n"
      "- {name: spring, type: spring, parent: a, child: b, pose: {xyz: [1, 0, 0]}, child_point: [0, 1, 0],"
      " stiffness: 100, rest: 0.5, damping: 2}\n"
      "- {name: twist, type: torsion_spring, child: b, axis: [1, 0, 0], stiffness: 3, rest: -1}\n");
  const auto joint = [&](const char* name) {
    return scene.world.joints[scene.world.find_joint(name).index()];
  };
  EXPECT_EQ(joint("ball").kind, JointKind::kBall);
  EXPECT_EQ(joint("universal").axis_J, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(joint("universal").axis2_J, Eigen::Vector3d::UnitY());
  EXPECT_EQ(joint("cylindrical").kind, JointKind::kCylindrical);
  EXPECT_EQ(joint("screw").pitch_m, -0.005);
  EXPECT_EQ(joint("screw").initial_position, 2.0);
  EXPECT_EQ(joint("plane").kind, JointKind::kPointOnPlane);
  EXPECT_EQ(joint("line").kind, JointKind::kPointOnLine);
  EXPECT_TRUE(joint("curve").curve_J.closed());
  EXPECT_NEAR(joint("curve").curve_J.length(), 2.0 + std::sqrt(2.0), 1e-12);
  EXPECT_EQ(joint("spring").X_PJ.p, Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(joint("spring").X_CJ.p, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(joint("spring").stiffness, 100.0);
  EXPECT_EQ(joint("spring").damping, 2.0);
  EXPECT_EQ(joint("twist").rest, -1.0);
  EXPECT_TRUE(scene.world.no_collision.empty()) << "a spring does not keep two bodies apart";
}

TEST(Scene, WhatAJointConnectsNeverCollides) {
  const auto& world = complete().world;
  const auto never = [&](const std::string& a, const std::string& b) {
    std::pair pair(world.find_body(a), world.find_body(b));
    if (pair.second < pair.first) std::swap(pair.first, pair.second);
    return std::count(world.no_collision.begin(), world.no_collision.end(), pair) == 1;
  };
  EXPECT_TRUE(never("crate", "lid"));
  EXPECT_TRUE(never("arm/base", "arm/zz_upper_arm"));
  EXPECT_TRUE(never("arm/base", "arm/lower_arm")) << "the model's own list";
  EXPECT_TRUE(never("ball", "arm/lower_arm")) << "the scene's list";
  EXPECT_FALSE(never("ball", "wedge"));
}

TEST(Scene, JointsStandParentsFirst) {
  const Scene scene = load_text(
      "visum: 1\nbodies:\n- {name: a, mass: 1, shapes: [{sphere: 1}]}\n- {name: b, mass: 1, shapes: "
      "[{sphere: 1}]}\n"
      "- {name: c, mass: 1, shapes: [{sphere: 1}]}\njoints:\n"
      "- {name: j2, type: hinge, parent: a, child: b, axis: [0, 0, 1]}\n"
      "- {name: j3, type: hinge, parent: b, child: c, axis: [0, 0, 1]}\n"
      "- {name: j1, type: slider, child: a, axis: [0, 0, 1]}\n"
      "- {name: loop, type: hinge, parent: a, child: c, axis: [0, 0, 1]}\n");
  std::vector<std::string> names;
  for (const auto& joint : scene.world.joints) names.push_back(joint.name);
  EXPECT_THAT(names, ElementsAre("j1", "j2", "j3", "loop"));
}

TEST(Scene, PartsKnowTheirJoints) {
  const Scene& scene = complete();
  ASSERT_EQ(scene.parts.size(), 1u);
  const PartPlan& part = scene.parts[0];
  EXPECT_EQ(part.kind, "amtec_arm");
  EXPECT_EQ(part.context.name, "arm");
  EXPECT_EQ(part.context.tick_s, 1e-3);
  EXPECT_EQ(part.context.config.place().key, "parts[0]");
  ASSERT_EQ(part.context.joints.size(), 2u) << "'grip' follows 'elbow', so the part has no port for it";
  EXPECT_EQ(part.context.joints[0].name, "shoulder");
  EXPECT_EQ(part.context.joints[0].initial_position, 0.5);
  EXPECT_EQ(part.context.joints[0].lower, -1.5);
  EXPECT_GT(part.context.joints[1].lower, part.context.joints[1].upper) << "elbow: no stops";
  EXPECT_EQ(scene.world.joints[part.joints[1].index()].name, "arm/elbow");
  ASSERT_EQ(scene.followers.size(), 1u);
  EXPECT_EQ(scene.world.joints[scene.followers[0].joint.index()].name, "arm/grip");
  EXPECT_EQ(scene.followers[0].leader, part.joints[1]);
  EXPECT_EQ(scene.followers[0].maximum_effort, 10.0);
}

TEST(Scene, PartsMayPickJointsAndNameThemInFull) {
  const std::string robot = "models: [{name: arm, file: '" + (kData / "robot.urdf").string() + "'}]\n";
  Scene scene =
      load_text("visum: 1\n" + robot + "parts: [{name: p, kind: k, model: arm, joints: [grip, shoulder]}]");
  ASSERT_EQ(scene.parts[0].context.joints.size(), 2u);
  EXPECT_EQ(scene.parts[0].context.joints[0].name, "shoulder") << "in the model's order";
  EXPECT_TRUE(scene.parts[0].context.joints[1].prismatic);
  EXPECT_EQ(scene.world.joints[scene.parts[0].joints[1].index()].name, "arm/grip");
  scene = load_text("visum: 1\n" + robot +
                    "parts: [{name: p, kind: k, joints: [arm/elbow]}, {name: q, kind: k}]");
  EXPECT_EQ(scene.parts[0].context.joints[0].name, "arm/elbow");
  EXPECT_TRUE(scene.parts[1].joints.empty());
}

TEST(Scene, ABodyMayHangOnALinkThatWasJoined) {
  const Scene scene = load_text("visum: 1\nmodels: [{name: arm, file: '" + (kData / "robot.urdf").string() +
                                "'}]\n"
                                "bodies: [{name: gun, mass: 1, shapes: [{sphere: 0.1}]}]\n"
                                "joints: [{name: mount, type: fixed, parent: arm/tcp, child: gun}]");
  const world::Joint& mount = scene.world.joints[scene.world.find_joint("mount").index()];
  EXPECT_EQ(mount.parent, scene.world.find_body("arm/lower_arm"));
  // tool is turned by a quarter about z, so that tcp's x is the lower arm's y.
  EXPECT_TRUE(mount.X_PJ.p.isApprox(Eigen::Vector3d(0, 0.3, 0)));
}

TEST(Scene, SelfCollisionCanBeSwitchedOff) {
  const Scene scene = load_text("visum: 1\nmodels: [{name: arm, self_collision: false, file: '" +
                                (kData / "robot.urdf").string() + "'}]\n");
  EXPECT_EQ(scene.world.bodies.size(), 4u);
  EXPECT_EQ(scene.world.no_collision.size(), 6u);
}

TEST(Scene, LinksOfAnSdfCollideAsItsFileSaysUnlessTheEntryDoes) {
  const test::TempFiles files;
  const auto pairs = [&](const std::string& top, const std::string& last_link, const std::string& entry) {
    files.write("m.sdf",
                "<sdf version='1.9'><model name='m'>" + top +
                    "<link name='a'/><link name='b'/><link name='c'>" + last_link +
                    "</link><model name='inner'><link name='d'/><link name='e'/></model></model></sdf>");
    const auto scene = load_scene(
        files.write("s.yaml", "visum: 1\nmodels: [{name: m, file: m.sdf, fixed: false" + entry + "}]"));
    return scene.world.no_collision.size();
  };
  const std::string yes = "<self_collide>true</self_collide>";
  EXPECT_EQ(pairs("", "", ""), 4u) << "three of the outer model, one of the inner one";
  EXPECT_EQ(pairs(yes, "", ""), 1u);
  EXPECT_EQ(pairs("", yes, ""), 2u) << "one link that says so meets all others of its model";
  EXPECT_EQ(pairs("", "", ", self_collision: true"), 0u);
  EXPECT_EQ(pairs(yes, "", ", self_collision: false"), 10u);
}

TEST(AddBody, AppendsToTheWorld) {
  Scene scene = load_scene(kData / "complete.yaml");
  const std::size_t before = scene.world.bodies.size();
  add_body(
      scene,
      "{name: new, mass: 1, engine: fast, shapes: [{box: [1, 1, 1], surface: rubber}, {mesh: wedge.obj}]}");
  EXPECT_EQ(scene.world.bodies.size(), before + 1);
  EXPECT_EQ(scene.world.bodies.back().engine, 1);
  EXPECT_EQ(shapes_of(scene, "new").size(), 2u);
  EXPECT_EQ(world::find_fault(scene.world), "");
}

TEST(AddBody, ChangesNothingIfWrong) {
  Scene scene = load_scene(kData / "complete.yaml");
  const auto counts = [&] {
    return std::vector{scene.world.bodies.size(), scene.world.shapes.size(), scene.world.meshes.size(),
                       scene.world.no_collision.size(), scene.losses.size()};
  };
  const auto before = counts();
  const auto error = [&](const std::string& yaml) {
    return test::TempFiles().error_of([&] { add_body(scene, yaml); });
  };
  EXPECT_EQ(error("{name: x, mass: -1, shapes: [{box: [1, 1, 1]}]}"),
            "added body:1: mass: must be greater than 0, is -1");
  EXPECT_THAT(error("{name: ball, mass: 1, shapes: [{box: [1, 1, 1]}]}"),
              HasSubstr("added body:1: there is already a body 'ball'"));
  EXPECT_EQ(error("{name: x, mass: 1, shapes: [{mesh: wedge.obj}, {box: [1, 1]}]}"),
            "added body:1: shapes[1].box: must be a list of 3 numbers, has 2");
  EXPECT_EQ(error("[]"), "added body:1: must be a map, is a list");
  EXPECT_EQ(counts(), before);
}

// Neither is parsed: the errors name no line.
TEST(AddBody, RefusesATextThatIsTooLongBeforeItParsesIt) {
  Scene scene = load_scene(kData / "complete.yaml");
  const auto error = [&](const std::string& yaml) {
    return test::TempFiles().error_of([&] { add_body(scene, yaml); });
  };
  EXPECT_EQ(error("{name: [" + std::string(kMaxBodyBytes, 'x')),
            "added body: has 1048584 bytes, an added body has at most 1048576");
  std::string list = "{name: [";
  while (list.size() < 300'000) list += "1, ";
  EXPECT_THAT(error(list), HasSubstr("added body: has more than 100000 values"));
}

TEST(AddBody, TakesABodyWithAsManyShapesAsItMayHave) {
  Scene scene = load_scene(kData / "complete.yaml");
  std::string yaml = "{name: new, mass: 1, shapes: [";
  for (int i = 0; i < 1000; ++i)
    yaml += "{box: [0.1, 0.2, 0.3], pose: {xyz: [1.25, -2.5, " + std::to_string(i) +
            ".125], rpy: [0.1, -0.2, 0.3]}, color: [1, 0.5, 0.25, 1], collides: true},\n";
  add_body(scene, yaml + "]}");
  EXPECT_EQ(shapes_of(scene, "new").size(), 1000u);
}

}  // namespace
}  // namespace visum::scene
