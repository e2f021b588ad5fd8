// Wrong scenes: each is refused with file, line, key and reason.
#include <gtest/gtest.h>

#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

const std::string kDataFolder = VISUM_SOURCE_DIR "/tests/scene/data";

std::string scene_error(const std::string& yaml) {
  const test::TempFiles files;
  const auto file = files.write("s.yaml", yaml);
  return files.error_of([&] { load_scene(file); });
}

struct BadCase {
  std::string yaml;  // without the first line "visum: 1\n"
  std::string message;
};

void expect_all(const std::vector<BadCase>& table) {
  for (const BadCase& bad : table)
    EXPECT_EQ(scene_error("visum: 1\n" + bad.yaml), "s.yaml:" + bad.message) << bad.yaml;
}

TEST(BadScene, TheHeaderIsChecked) {
  EXPECT_EQ(scene_error(""), "s.yaml:1: must be a map, is empty");
  EXPECT_EQ(scene_error("[1, 2]"), "s.yaml:1: must be a map, is a list");
  EXPECT_EQ(scene_error("name: x"), "s.yaml:1: key 'visum' is missing");
  EXPECT_EQ(scene_error("visum: 2"),
            "s.yaml:1: visum: this is version 2 of the format, only version 1 is known here");
  EXPECT_EQ(scene_error("visum: one"), "s.yaml:1: visum: must be a whole number, is 'one'");
}

TEST(BadScene, SettingsAreChecked) {
  expect_all({
      {"nmae: x", "2: unknown key 'nmae'; did you mean 'name'?"},
      {"name: a/b", "2: name: must not hold a '/', is 'a/b'"},
      {"name: ''", "2: name: must not be empty"},
      {"gravity: [0, 0]", "2: gravity: must be a list of 3 numbers, has 2"},
      {"gravity: [0, 0, .nan]", "2: gravity[2]: must be a finite number, is .nan"},
      {"gravity: [0, 0, 1e308]", "2: gravity[2]: must be between -1e+06 and 1e+06, is 1e308"},
      {"tick_ms: 0", "2: tick_ms: must be greater than 0 and at most 1000, is 0"},
      {"tick_ms: 1.00000001", "2: tick_ms: must be a whole number of nanoseconds, is 1.00000001 ms"},
      {"tick_ms: 1e-9", "2: tick_ms: must be a whole number of nanoseconds, is 1e-9 ms"},
      {"clock: realtim",
       "2: clock: must be one of realtime, lockstep, free, is 'realtim'; did you mean 'realtime'?"},
      {"speed: -1", "2: speed: must be between 0.001 and 1000, is -1"},
      {"speed: 1e-300", "2: speed: must be between 0.001 and 1000, is 1e-300"},
      {"seed: -1", "2: seed: must be a whole number between 0 and 9223372036854775807, is -1"},
      {"lockstep_timeout_s: .inf", "2: lockstep_timeout_s: must be a finite number, is .inf"},
      {"engine: {step: quick}", "2: engine: key 'kind' is missing"},
      {"engine: {kind: ode, step: slow}", "2: engine.step: must be one of world, quick, is 'slow'"},
      {"engine: {kind: ode, cfm: 0}", "2: engine.cfm: must be between 1e-09 and 1e+06, is 0"},
      {"engine: {kind: ode, iterations: 0}",
       "2: engine.iterations: must be a whole number between 1 and 100000, is 0"},
      {"collision: bullet", "2: collision: must be one of visum, fcl, is 'bullet'"},
      {"collision: {stage: [fcl]}", "2: collision.stage: must be a text, is a list"},
      {"engine: {kind: impulse, solver: fast}",
       "2: engine.solver: must be one of direct, iterate, is 'fast'"},
      {"engine: {kind: impulse, order: 3}", "2: engine.order: must be 2, 4 or 6, is 3"},
      {"engine: {kind: impulse, d_max: 0}", "2: engine.d_max: must be greater than 0 and at most 1, is 0"},
      {"engine: {kind: impulse, v_max: -1}",
       "2: engine.v_max: must be greater than 0 and at most 1e+06, is -1"},
      {"engine: {kind: impulse, budget: 0}",
       "2: engine.budget: must be a whole number between 1 and 100000, is 0"},
      {"engine: {kind: impulse, impact: hard}",
       "2: engine.impact: must be one of newton, poisson, is 'hard'"},
      {"engines: {default: ode}",
       "2: engines.default: this name stands for the scene's 'engine', choose another"},
      {"surfaces: {wood: {friction: -0.1}}",
       "2: surfaces.wood.friction: must be between 0 and 1e+06, is -0.1"},
      {"surfaces: {wood: {restitution: 1.5}}",
       "2: surfaces.wood.restitution: must be between 0 and 1, is 1.5"},
      {"surfaces: {wood: {rolling_friction: -0.1}}",
       "2: surfaces.wood.rolling_friction: must be between 0 and 1e+06, is -0.1"},
      {"surfaces: {wood: {torsional_friction: -0.1}}",
       "2: surfaces.wood.torsional_friction: must be between 0 and 1e+06, is -0.1"},
      {"engine: {kind: impulse, sleep: -1}", "2: engine.sleep: must be between 0 and 86400, is -1"},
      {"surfaces: {wood: {frition: 1}}", "2: surfaces.wood: unknown key 'frition'; did you mean 'friction'?"},
      {"bodies: {a: 1}", "2: bodies: must be a list, is a map"},
  });
}

TEST(BadScene, BodiesAreChecked) {
  const std::string sphere = "shapes: [{sphere: 1}]}]";
  expect_all({
      {"bodies:\n- name: a\n- {name: b, mass: -1, " + sphere.substr(0, sphere.size() - 1),
       "3: bodies[0]: needs 'mass', 'density', 'fixed: true' or 'kinematic: true'"},
      {"bodies: [{name: a, mass: -1, " + sphere, "2: bodies[0].mass: must be greater than 0, is -1"},
      {"bodies: [{name: a, masss: 1, " + sphere, "2: bodies[0]: unknown key 'masss'; did you mean 'mass'?"},
      {"bodies: [{name: a, mass: 0, " + sphere, "2: bodies[0].mass: must be greater than 0, is 0"},
      {"bodies: [{name: a, mass: heavy, " + sphere, "2: bodies[0].mass: must be a number, is 'heavy'"},
      {"bodies: [{name: a, mass: 1e308, " + sphere,
       "2: bodies[0]: body 'a' needs a mass between 1e-9 and 1e12 kg"},
      {"bodies: [{name: a, mass: 1, density: 1, " + sphere,
       "2: bodies[0]: has both 'mass' and 'density', one is enough"},
      {"bodies: [{name: a, mass: 1}]",
       "2: bodies[0]: has no shape that collides to compute its inertia from: give 'mass' and 'inertia'"},
      {"bodies: [{name: a, mass: 1, shapes: [{sphere: 1, collides: false}]}]",
       "2: bodies[0]: has no shape that collides to compute its inertia from: give 'mass' and 'inertia'"},
      {"bodies: [{name: a, mass: 1, inertia: [1, 1, 3, 0, 0, 0]}]",
       "2: bodies[0]: body 'a' has principal moments of inertia that no solid has (A + B < C)"},
      {"bodies: [{name: a, mass: 1, inertia: [1, 1, 1]}]",
       "2: bodies[0].inertia: must be a list of 6 numbers, has 3"},
      {"bodies: [{name: a, density: 1, inertia: [1, 1, 1, 0, 0, 0]}]",
       "2: bodies[0].inertia: needs 'mass' beside it"},
      {"bodies: [{name: a, mass: 1, com: [0, 0, 0], " + sphere,
       "2: bodies[0].com: needs 'inertia' beside it (without, both come from the shapes)"},
      {"bodies: [{name: a, fixed: true, mass: 1, " + sphere,
       "2: bodies[0].mass: means nothing for a body with 'fixed: true'"},
      {"bodies: [{name: a, fixed: maybe}]", "2: bodies[0].fixed: must be true or false, is 'maybe'"},
      {"bodies: [{fixed: true}]", "2: bodies[0]: key 'name' is missing"},
      {"bodies:\n- {name: a, fixed: true}\n- {name: a, fixed: true}",
       "4: bodies[1]: there is already a body 'a' (s.yaml:3)"},
      {"bodies: [{name: a, fixed: true, pose: {xyz: [0, 0, 0], wxyz: [0.5, 0, 0, 0]}}]",
       "2: bodies[0].pose.wxyz: must be a unit quaternion [w, x, y, z], has length 0.500000"},
      {"bodies: [{name: a, fixed: true, pose: {rpy: [0, 0, 0], wxyz: [1, 0, 0, 0]}}]",
       "2: bodies[0].pose: has both 'rpy' and 'wxyz', one is enough"},
      {"bodies: [{name: a, fixed: true, pose: [0, 0, 0]}]", "2: bodies[0].pose: must be a map, is a list"},
      {"bodies: [{name: a, fixed: true, pose: {xyz: [0, 0, 1e7]}}]",
       "2: bodies[0].pose.xyz[2]: must be between -1e+06 and 1e+06, is 1e7"},
      {"bodies: [{name: a, mass: 1, engine: fats, " + sphere,
       "2: bodies[0].engine: there is no engine 'fats'; there is only 'default'"},
      {"bodies: [{name: a, mass: 1, velocity: {linear: [0, 0, .inf]}, " + sphere,
       "2: bodies[0].velocity.linear[2]: must be a finite number, is .inf"},
  });
}

TEST(BadScene, ShapesAreChecked) {
  const auto shape = [](const std::string& entry) {
    return "bodies: [{name: a, fixed: true, shapes: [{" + entry + "}]}]";
  };
  const std::string at = "2: bodies[0].shapes[0]";
  expect_all({
      {shape("box: [1, 0, 1]"), at + ".box[1]: must be greater than 0 and at most 1e+06, is 0"},
      {shape("box: [1, 1e-9, 1]"), at + ": shape 'box_0' needs sizes between 1e-6 and 1e6 m"},
      {shape("sphere: .nan"), at + ".sphere: must be a finite number, is .nan"},
      {shape("cylinder: {radius: 1}"), at + ".cylinder: key 'length' is missing"},
      {shape("cylinder: {radius: 1, lenght: 1}"),
       at + ".cylinder: unknown key 'lenght'; did you mean 'length'?"},
      {shape("sphere: 1, box: [1, 1, 1]"), at + ": is both 'box' and 'sphere', needs one"},
      {shape("pose: {}"), at + ": needs one of box, sphere, cylinder, capsule, plane, convex or mesh"},
      {shape("cone: 1"), at + ": unknown key 'cone'"},
      {shape("plane: false"), at + ".plane: must be true, or left out"},
      {shape("sphere: 1, scale: 2"), at + ".scale: only 'convex' and 'mesh' are scaled"},
      {shape("sphere: 1, surface: rubbr"),
       at + ".surface: there is no surface 'rubbr'; there is only 'default'"},
      {shape("sphere: 1, color: [1, 2, 3]"), at + ".color[1]: must be between 0 and 1, is 2"},
      {shape("sphere: 1, color: [1]"), at + ".color: must be [r, g, b] or [r, g, b, a], has 1 numbers"},
      {shape("mesh: gone.stl"), at + ".mesh: 'gone.stl': no such file"},
      {shape("mesh: 'http://x.org/a.stl'"),
       at + ".mesh: must be a file, is the address 'http://x.org/a.stl'"},
      {shape("mesh: '" + kDataFolder + "/wedge.obj', scale: 0"), at + ".scale: must not be zero"},
      {shape("convex: '" + kDataFolder + "/wedge.obj', scale: [1, 1, 1e-30]"),
       at + ": shape 'convex_0' is a hull without volume"},
      {"bodies: [{name: a, mass: 1, shapes: [{plane: true}]}]",
       at + ": a plane is for bodies with 'fixed: true'"},
  });
}

TEST(BadScene, MeshesOfMovingBodiesMustBeClosed) {
  const test::TempFiles files;
  files.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto file =
      files.write("s.yaml", "visum: 1\nbodies: [{name: a, mass: 1, shapes: [{mesh: open.obj}]}]");
  EXPECT_EQ(files.error_of([&] { load_scene(file); }),
            "s.yaml:2: bodies[0].shapes[0]: mesh 'open.obj' is not closed (an edge has no neighbour, or "
            "faces are turned "
            "inside out), so it has no inertia: give the body 'mass' and 'inertia'");
}

TEST(BadScene, JointsAreChecked) {
  const std::string bodies =
      "bodies: [{name: a, mass: 1, shapes: [{sphere: 1}]}, {name: b, mass: 1, shapes: [{sphere: 1}]}, {name: "
      "f, fixed: true}]\n";
  const auto joint = [&](const std::string& rest) { return bodies + "joints: [{name: j, " + rest + "}]"; };
  expect_all({
      {joint("type: hinge, parent: a, child: b"), "3: joints[0]: key 'axis' is missing"},
      {joint("type: hinge, parent: a, child: b, axis: [0, 0, 0]"), "3: joints[0].axis: must not be zero"},
      {joint("type: hing, parent: a, child: b"),
       "3: joints[0].type: must be one of fixed, hinge, slider, ball, universal, cylindrical, screw, "
       "point_on_plane, point_on_line, point_on_curve, spring, torsion_spring, is 'hing'; did you mean "
       "'hinge'?"},
      {joint("type: fixed, parent: a, child: c"),
       "3: joints[0].child: there is no body 'c'; did you mean 'a'?"},
      {joint("type: fixed, parent: a, child: a"), "3: joints[0].child: is the same body as the parent"},
      {joint("type: fixed, parent: a, child: f"),
       "3: joints[0].child: must be a body that moves; make the fixed one the parent"},
      {joint("type: fixed, parent: a, child: b, axis: [1, 0, 0]"),
       "3: joints[0].axis: means nothing for a joint of type fixed"},
      {joint("type: hinge, child: b, axis: [1, 0, 0], limits: [1, -1]"),
       "3: joints[0].limits: the lower limit is above the upper one"},
      {joint("type: hinge, child: b, axis: [1, 0, 0], limits: [0, 1], position: 2"),
       "3: joints[0].position: must be within the joint's limits 0 and 1, is 2"},
      {joint("type: hinge, child: b, axis: [1, 0, 0], friction: -1"),
       "3: joints[0].friction: must be between 0 and 1e+06, is -1"},
      {joint("type: ball, child: b, axis: [1, 0, 0]"),
       "3: joints[0].axis: means nothing for a joint of type ball"},
      {joint("type: cylindrical, child: b, axis: [1, 0, 0], limits: [0, 1]"),
       "3: joints[0].limits: means nothing for a joint of type cylindrical"},
      {joint("type: hinge, child: b, axis: [1, 0, 0], pitch: 1"),
       "3: joints[0].pitch: means nothing for a joint of type hinge"},
      {joint("type: screw, child: b, axis: [1, 0, 0]"), "3: joints[0]: key 'pitch' is missing"},
      {joint("type: universal, child: b, axis: [1, 0, 0], axis2: [1, 1, 0]"),
       "3: joints[0].axis2: must be perpendicular to 'axis'"},
      {joint("type: point_on_curve, child: b, points: [[0, 0, 0]]"),
       "3: joints[0].points: must be at least 2 points, neighbours apart"},
      {joint("type: point_on_curve, child: b, points: [[0, 1, 0], [2, 1, 0]]"),
       "3: joints[0]: joint 'j' has a curve that does not pass through the joint's place"},
      {joint("type: spring, child: b, child_point: [0, 0, 0], stiffness: 1, rest: -1"),
       "3: joints[0].rest: must be between 0 and 1e+06, is -1"},
      {joint("type: torsion_spring, child: b, axis: [1, 0, 0], stiffness: -1, rest: 0"),
       "3: joints[0].stiffness: must be between 0 and 1e+12, is -1"},
      {joint("type: fixed, child: b}, {name: j, type: fixed, child: a"),
       "3: joints[1]: there is already a joint 'j' (s.yaml:3)"},
      {joint("type: fixed, parent: a, child: b}, {name: k, type: fixed, parent: b, child: a"),
       " joint 'j' hangs below itself: its parents form a cycle"},
      {"engines: {e: ode}\nbodies: [{name: a, mass: 1, shapes: [{sphere: 1}]}, {name: b, mass: 1, engine: e, "
       "shapes: "
       "[{sphere: 1}]}]\njoints: [{name: j, type: fixed, parent: a, child: b}]",
       "4: joints[0]: joint 'j' connects bodies of two engines"},
      {bodies + "no_collision: [[a, b, f]]", "3: no_collision[0]: must be two bodies, has 3"},
      {bodies + "no_collision: [[a, bb]]", "3: no_collision[0][1]: there is no body 'bb'; did you mean 'b'?"},
  });
}

TEST(BadScene, ModelsAndPartsAreChecked) {
  const std::string file = "file: '" + kDataFolder + "/robot.urdf'";
  const auto model = [&](const std::string& rest) {
    return "models: [{name: arm, " + file + ", " + rest + "}]";
  };
  const std::string good = "models: [{name: arm, " + file + "}]\n";
  expect_all({
      {"models: [{name: arm}]", "2: models[0]: key 'file' is missing"},
      {"models: [{name: arm, file: gone.urdf}]", "2: models[0].file: 'gone.urdf': no such file"},
      {"models: [{name: arm, file: .}]", "2: models[0].file: '': is a folder, not a file"},
      {model("joints: {sholder: 1}"), "2: models[0].joints: unknown key 'sholder'; did you mean 'shoulder'?"},
      {model("joints: {shoulder: 2}"),
       "2: models[0].joints.shoulder: must be within the joint's limits -1.5 and 1.5, is 2"},
      {model("joints: {shoulder: .nan}"), "2: models[0].joints.shoulder: must be a finite number, is .nan"},
      {model("surfaces: {tol: default}"), "2: models[0].surfaces: unknown key 'tol'; did you mean 'tool'?"},
      {model("surfaces: {tool: rubber}"),
       "2: models[0].surfaces.tool: there is no surface 'rubber'; there is only 'default'"},
      {model("no_collision: [[base, lower_amr]]"),
       "2: models[0].no_collision[0][1]: there is no body 'lower_amr'; did you mean 'lower_arm'?"},
      {model("engine: fast"), "2: models[0].engine: there is no engine 'fast'; there is only 'default'"},
      {good + "parts: [{name: p}]", "3: parts[0]: key 'kind' is missing"},
      {good + "parts: [{name: p, kind: k, model: arn}]",
       "3: parts[0].model: there is no model 'arn'; did you mean 'arm'?"},
      {good + "parts: [{name: p, kind: k, model: arm, joints: [elbwo]}]",
       "3: parts[0].joints[0]: there is no movable joint 'elbwo'; did you mean 'elbow'?"},
      {good + "parts: [{name: p, kind: k, model: arm, joints: [elbow, elbow]}]",
       "3: parts[0].joints[1]: is named twice"},
      {good + "parts: [{name: p, kind: k, model: arm}, {name: q, kind: k, model: arm}]",
       "3: parts[1]: joint 'arm/shoulder' is driven by part 'p' already"},
      {good + "parts: [{name: p, kind: k}, {name: p, kind: k}]",
       "3: parts[1]: there is already a part 'p' (s.yaml:3)"},
  });
}

TEST(BadScene, AMovingLinkWithoutMassIsNamedInTheModelsFile) {
  EXPECT_EQ(test::TempFiles().error_of([] {
    const test::TempFiles files;
    const auto file =
        files.write("s.yaml", "visum: 1\nmodels: [{name: arm, fixed: false, repair: false, file: '" +
                                  kDataFolder + "/robot.urdf'}]");
    load_scene(file);
  }),
            kDataFolder + "/robot.urdf:5: link 'base': moves but has no mass: give it an <inertial>");
}

TEST(BadScene, IncludesAreFollowedWithCare) {
  const test::TempFiles files;
  const auto load = [&](const std::string& name) {
    return files.error_of([&] { load_scene(files.folder() / name); });
  };
  EXPECT_EQ(load("none.yaml"), "none.yaml: no such file");
  files.write("gone.yaml", "visum: 1\ninclude:\n- other.yaml\n");
  EXPECT_EQ(load("gone.yaml"), "gone.yaml:3: include[0]: 'other.yaml': no such file");
  files.write("a.yaml", "visum: 1\ninclude: [sub/b.yaml]");
  files.write("sub/b.yaml", "visum: 1\ninclude: [../c.yaml]");
  files.write("c.yaml", "visum: 1\ninclude: [./a.yaml]");
  EXPECT_EQ(
      load("a.yaml"),
      "c.yaml:2: include[0]: files include each other in a circle: a.yaml -> b.yaml -> c.yaml -> a.yaml "
      "(included from sub/b.yaml:2)");
  files.write("twice.yaml", "visum: 1\ninclude: [room.yaml, room.yaml]");
  files.write("room.yaml", "visum: 1\nbodies: [{name: floor, fixed: true}]");
  EXPECT_EQ(
      load("twice.yaml"),
      "room.yaml:2: bodies[0]: there is already a body 'floor' (room.yaml:2) (included from twice.yaml:2)");
  for (int i = 0; i < 20; ++i)
    files.write("deep" + std::to_string(i) + ".yaml",
                "visum: 1\ninclude: [deep" + std::to_string(i + 1) + ".yaml]");
  EXPECT_EQ(load("deep0.yaml"),
            "deep15.yaml:2: include[0]: files include each other more than 16 levels deep (included from "
            "deep14.yaml:2)");
  for (int i = 0; i < 14; ++i) {
    const std::string next = "wide" + std::to_string(i + 1) + ".yaml";
    files.write("wide" + std::to_string(i) + ".yaml", "visum: 1\ninclude: [" + next + ", " + next + "]");
  }
  files.write("wide14.yaml", "visum: 1");
  EXPECT_NE(load("wide0.yaml").find("more than 4096 files are included"), std::string::npos);
}

TEST(BadScene, FaultsInMeshesAndModelsNameTheirOwnFiles) {
  const test::TempFiles files;
  files.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
  files.write("bad.urdf", "<robot name='r'>\n<link name='a'>");
  const auto load = [&](const std::string& yaml) {
    const auto file = files.write("s.yaml", yaml);
    return files.error_of([&] { load_scene(file); });
  };
  EXPECT_EQ(load("visum: 1\nbodies: [{name: a, fixed: true, shapes: [{mesh: bad.obj}]}]"),
            "bad.obj:2: face names vertex 2, there are 1 so far");
  std::filesystem::resize_file(files.write("huge.urdf", "<robot"), (16u << 20) + 1);
  EXPECT_EQ(load("visum: 1\nmodels: [{name: a, file: huge.urdf}]"),
            "s.yaml:2: models[0].file: 'huge.urdf': has 16777217 bytes, at most 16777216 are read");
  EXPECT_EQ(load("visum: 1\nmodels: [{name: a, file: bad.urdf}]"),
            "bad.urdf:2: not valid XML: an element is not closed, or by another one's name");
}

}  // namespace
}  // namespace visum::scene
