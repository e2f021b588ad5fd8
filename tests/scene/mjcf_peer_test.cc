// MJCF files as MuJoCo itself reads and moves them: masses, inertias, frames, and a free swing.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "server/cycle/simulation.h"
#include "server/scene/inertia.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSwingS = 0.3;
constexpr double kTickS = 0.00025;
constexpr int kStepsPerTick = 2;  // of MuJoCo's Runge-Kutta

// Nothing collides, and MuJoCo's steps are short.
const std::string kHead =
    "<mujoco model='m'><option integrator='RK4' timestep='0.000125'><flag contact='disable'/></option>";
const std::string kNoContact = "<default><geom contype='0' conaffinity='0'/></default>";

const std::string kChain = kHead + R"(<compiler angle='radian' eulerseq='XYZ'/>
<default>
  <geom contype='0' conaffinity='0' density='700'/><joint damping='0.02'/>
  <default class='thin'><geom type='capsule' size='0.02 0.1'/><joint axis='0 1 0' damping='0'/></default>
</default>
<worldbody>
  <geom type='plane' size='1 1 0.1'/>
  <body name='upper' pos='0.1 0.2 1' euler='0.3 -0.2 0.5' childclass='thin'>
    <joint name='shoulder' pos='0 0 0.1'/>
    <geom fromto='0 0 0.1 0.3 0 0.05'/>
    <geom type='box' size='0.03 0.04 0.05' pos='0.1 0 0' axisangle='1 1 0 0.4' density='1200'/>
    <body name='plate' pos='0.1 0 0.05' xyaxes='1 1 0 -1 1 0'>
      <geom class='main' type='cylinder' size='0.05 0.01' mass='0.3'/>
      <body name='lower' pos='0.2 0 0' zaxis='1 0 0.2'>
        <joint name='elbow' class='main' axis='1 0.3 0' range='-2 2.5' limited='true'/>
        <inertial pos='0.01 0.02 0.1' quat='0.9 0.1 0.2 0.3' mass='0.8' diaginertia='0.004 0.005 0.003'/>
        <geom size='0.05'/>
      </body>
    </body>
  </body>
  <body name='other' pos='1 0 1'>
    <joint name='hang' axis='0 1 0' pos='-0.2 0 0'/>
    <inertial pos='0 0 0' mass='1.5' fullinertia='0.02 0.03 0.04 0.001 -0.002 0.003'/>
  </body>
</worldbody></mujoco>)";

const std::string kWalker = kHead + kNoContact + R"(<compiler settotalmass='9'/>
<worldbody>
  <body name='torso' pos='0 0 1.2'>
    <joint name='x' type='slide' axis='1 0 0'/><joint name='z' type='slide' axis='0 0 1' ref='1.2'/>
    <joint name='tilt' axis='0 1 0' pos='0 0 0.1' ref='10'/>
    <geom type='capsule' fromto='0 0 -0.2 0 0 0.3' size='0.07'/>
    <body name='thigh' pos='0.1 0 -0.2'>
      <joint name='hip_x' axis='1 0 0'/><joint name='hip_z' axis='0 0 1'/>
      <joint name='hip_y' axis='0 1 0' range='-110 20' limited='true'/>
      <geom type='capsule' fromto='0 0 0 0.3 0.05 -0.3' size='0.05'/>
      <body name='shin' pos='0.3 0.05 -0.3'>
        <joint name='knee' axis='0 1 0' stiffness='4' springref='-30' damping='0.1'/>
        <geom type='ellipsoid' size='0.04 0.05 0.2' pos='0 0 -0.2'/>
      </body>
    </body>
  </body>
</worldbody></mujoco>)";

// The mesh has a mass, because version 2.2.2 takes the volume of another box for it.
const std::string kFlyer =
    kHead + kNoContact + R"(<asset><mesh name='wedge' file='wedge.obj' scale='0.2 0.1 0.3'/></asset>
<worldbody>
  <body name='hull' pos='0 0 2' quat='1 0.2 0 0.1'>
    <freejoint/>
    <geom type='mesh' mesh='wedge' mass='3' pos='0.02 0 0.01' euler='10 20 30'/>
    <body name='tail' pos='-0.2 0 0'>
      <joint type='ball' pos='0.01 0 0'/>
      <geom type='box' fromto='0 0 0 -0.3 0.1 0.1' size='0.03'/>
    </body>
    <body name='spring' pos='0.2 0 0'>
      <joint name='slide' type='slide' axis='0 1 1' stiffness='300' springref='0.05' damping='1'/>
      <geom size='0.06' density='2000'/>
    </body>
  </body>
</worldbody></mujoco>)";

const std::string kWedge =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 3 2\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 "
    "6\n";

class Peers {
 public:
  explicit Peers(const std::string& text) {
    files_.write("wedge.obj", kWedge);
    const auto file = files_.write("model.xml", text);
    char error[1000] = "";
    model = mj_loadXML(file.c_str(), nullptr, error, sizeof error);
    if (model == nullptr) throw std::runtime_error(error);
    data = mj_makeData(model);
    mj_forward(model, data);
    ours = std::make_unique<cycle::Simulation>(
        load_scene(files_.write("scene.yaml",
                                "visum: 1\nengine: {kind: impulse}\ntick_ms: 0.25\nclock: free\nmodels: "
                                "[{name: m, file: model.xml}]\n")));
  }
  ~Peers() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  Peers(const Peers&) = delete;
  Peers& operator=(const Peers&) = delete;

  std::string name(int type, int id) const { return mj_id2name(model, type, id); }
  Vector3d position(int body) const { return Eigen::Map<const Vector3d>(data->xpos + 3 * body); }
  Matrix3d rotation(const mjtNum* nine) const {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(nine);
  }

  // The mass of a body with all that is fixed to it, in the world's frame.
  MassProperties mass_of(int body) const {
    MassProperties sum;
    for (int i = 1; i < model->nbody; ++i) {
      if (model->body_weldid[i] != body) continue;
      const Matrix3d R = rotation(data->ximat + 9 * i);
      const Matrix3d I = Eigen::Map<const Vector3d>(model->body_inertia + 3 * i).asDiagonal();
      sum = together(
          sum, {model->body_mass[i], Eigen::Map<const Vector3d>(data->xipos + 3 * i), R * I * R.transpose()});
    }
    return sum;
  }
  // Ours, with the links between its joints.
  MassProperties our_mass_of(const std::string& name) const {
    MassProperties sum;
    for (std::size_t i = 0; i < ours->model().bodies.size(); ++i) {
      const world::Body& body = ours->model().bodies[i];
      if (body.name != "m/" + name && !body.name.starts_with("m/" + name + "~")) continue;
      sum = together(
          sum, moved({body.mass_kg, body.p_BC, body.inertia_C}, link_pose(body, ours->state().bodies[i])));
    }
    return sum;
  }
  world::Pose our_pose(const std::string& name) const {
    const world::BodyId id = ours->model().find_body("m/" + name);
    return link_pose(ours->model().bodies[id.index()], ours->state().bodies[id.index()]);
  }

  mjModel* model = nullptr;
  mjData* data = nullptr;
  std::unique_ptr<cycle::Simulation> ours;

 private:
  const test::TempFiles files_;
};

// A body that has joints, so that it is a body of ours, too.
bool is_root(const Peers& peers, int body) {
  return peers.model->body_weldid[body] == body;
}

void expect_same_frames(const Peers& peers, double tolerance) {
  for (int i = 1; i < peers.model->nbody; ++i) {
    if (!is_root(peers, i)) continue;
    const std::string name = peers.name(mjOBJ_BODY, i);
    const world::Pose ours = peers.our_pose(name);
    EXPECT_LT((ours.p - peers.position(i)).norm(), tolerance) << name;
    EXPECT_LT((ours.q.toRotationMatrix() - peers.rotation(peers.data->xmat + 9 * i)).norm(), 10 * tolerance)
        << name;
  }
}

class MjcfPeer : public testing::TestWithParam<std::string> {};

TEST_P(MjcfPeer, HasItsMassesInertiasAndFrames) {
  const Peers peers(GetParam());
  double sum = 0.0, our_sum = 0.0;
  for (int i = 1; i < peers.model->nbody; ++i) {
    if (!is_root(peers, i)) continue;
    const std::string name = peers.name(mjOBJ_BODY, i);
    const MassProperties theirs = peers.mass_of(i), ours = peers.our_mass_of(name);
    EXPECT_NEAR(ours.mass_kg, theirs.mass_kg, 1e-9 * theirs.mass_kg) << name;
    EXPECT_LT((ours.com - theirs.com).norm(), 1e-7) << name;  // MuJoCo's vertices are floats
    EXPECT_LT((ours.inertia_C - theirs.inertia_C).norm(), 1e-7 * theirs.inertia_C.norm()) << name;
    sum += theirs.mass_kg;
    our_sum += ours.mass_kg;
  }
  EXPECT_GT(sum, 0.0);
  EXPECT_NEAR(our_sum, sum, 1e-9 * sum);
  expect_same_frames(peers, 1e-9);
}

TEST_P(MjcfPeer, HasItsJointsAndLimits) {
  const Peers peers(GetParam());
  int compared = 0;
  for (int i = 0; i < peers.model->njnt; ++i) {
    const int type = peers.model->jnt_type[i];
    if (type != mjJNT_HINGE && type != mjJNT_SLIDE) continue;
    const world::JointId id = peers.ours->model().find_joint("m/" + peers.name(mjOBJ_JOINT, i));
    ASSERT_TRUE(id.valid()) << peers.name(mjOBJ_JOINT, i);
    const world::Joint& ours = peers.ours->model().joints[id.index()];
    EXPECT_EQ(ours.kind, type == mjJNT_HINGE ? world::JointKind::kHinge : world::JointKind::kSlider);
    EXPECT_EQ(ours.limited, peers.model->jnt_limited[i] != 0);
    if (ours.limited) {
      EXPECT_NEAR(ours.lower, peers.model->jnt_range[2 * i], 1e-12);
      EXPECT_NEAR(ours.upper, peers.model->jnt_range[2 * i + 1], 1e-12);
    }
    EXPECT_NEAR(ours.damping, peers.model->dof_damping[peers.model->jnt_dofadr[i]], 1e-12);
    EXPECT_NEAR(peers.ours->state().joints[id.index()].position,
                peers.data->qpos[peers.model->jnt_qposadr[i]], 1e-9);
    ++compared;
  }
  EXPECT_GT(compared, 0);
}

TEST_P(MjcfPeer, SwingsAlike) {
  const Peers peers(GetParam());
  const Vector3d start = peers.position(1);
  double moved = 0.0;
  for (int i = 0; i < static_cast<int>(kSwingS / kTickS); ++i) {
    peers.ours->tick();
    for (int k = 0; k < kStepsPerTick; ++k) mj_step(peers.model, peers.data);
  }
  mj_forward(peers.model, peers.data);
  for (int i = 1; i < peers.model->nbody; ++i) moved = std::max(moved, (peers.mass_of(i).com - start).norm());
  EXPECT_GT(moved, 0.1);
  expect_same_frames(peers, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Models, MjcfPeer, testing::Values(kChain, kWalker, kFlyer), [](const auto& tested) {
  return std::string(tested.index == 0 ? "Chain" : tested.index == 1 ? "Walker" : "Flyer");
});

}  // namespace
}  // namespace visum::scene
