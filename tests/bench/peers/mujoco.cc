#include <mujoco/mujoco.h>

#include <stdexcept>

#include "tests/bench/peers/mjcf.h"
#include "tests/bench/peers/peers.h"

namespace visum::bench {
namespace {

constexpr int kErrorLength = 512;
// MuJoCo keeps room for a dense matrix of all rows, 12 bytes by entry. Beyond, it needs gigabytes.
constexpr std::size_t kMostRows = 11'000;

// A swing that explodes shows in its figures. By default MuJoCo would also write a log into the working
// directory.
void say_nothing(const char*) {}

// MuJoCo reads its model from its own virtual file system, so no file on disk is needed.
mjModel* load(const std::string& text) {
  mju_user_warning = say_nothing;
  auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  const int size = static_cast<int>(text.size());
  if (mj_makeEmptyFileVFS(files.get(), "model.xml", size) != 0) throw std::runtime_error("MuJoCo's files");
  text.copy(static_cast<char*>(files->filedata[mj_findFileVFS(files.get(), "model.xml")]), text.size());
  char error[kErrorLength] = "";
  mjModel* model = mj_loadXML("model.xml", files.get(), error, kErrorLength);
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

Eigen::Vector3d vector(const mjtNum* from) {
  return {from[0], from[1], from[2]};
}

class Mujoco : public Stepper {
 public:
  Mujoco(const world::WorldModel& model, const char* integrator)
      : model_(load(mjcf(model, integrator))), data_(mj_makeData(model_)) {
    for (const auto& body : model.bodies) ids_.push_back(mj_name2id(model_, mjOBJ_BODY, body.name.c_str()));
    const auto start = initial_state(model);
    for (std::size_t i = 0; i < model.joints.size(); ++i) {
      const int id = mj_name2id(model_, mjOBJ_JOINT, model.joints[i].name.c_str());
      if (id >= 0 && model_->jnt_type[id] == mjJNT_HINGE)
        starts_.push_back({model_->jnt_qposadr[id], model_->jnt_dofadr[id], start.joints[i]});
    }
    reset();
  }
  ~Mujoco() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;

  void reset() override {
    mj_resetData(model_, data_);
    for (const auto& [position, velocity, joint] : starts_) {
      data_->qpos[position] = joint.position;
      data_->qvel[velocity] = joint.velocity;
    }
  }
  void step() override { mj_step(model_, data_); }
  void store(world::WorldState& state) const override {
    for (const int full : {mjWARN_CONTACTFULL, mjWARN_CNSTRFULL})
      if (data_->warning[full].number > 0) throw std::runtime_error("MuJoCo left contacts out");
    mj_forward(model_, data_);
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      if (ids_[i] <= 0) continue;  // scenery
      const mjtNum* q = data_->xquat + 4 * ids_[i];
      mjtNum velocity[6];
      mj_objectVelocity(model_, data_, mjOBJ_BODY, ids_[i], velocity, 0);
      state.bodies[i] = {vector(data_->xipos + 3 * ids_[i]), Eigen::Quaterniond(q[0], q[1], q[2], q[3]),
                         vector(velocity + 3), vector(velocity)};
    }
  }

 private:
  struct Start {
    int position, velocity;  // where they are in qpos and qvel
    world::JointState joint;
  };

  mjModel* model_;
  mjData* data_;
  std::vector<int> ids_;
  std::vector<Start> starts_;
};

bool takes(const world::WorldModel& model) {
  if (model.shapes.empty()) return is_mechanism(model) && mjcf_depth(model) <= kMaxMjcfDepth;
  return (is_boxes_only(model) || is_jointed_scene(model)) && mjcf_rows(model) <= kMostRows;
}

std::unique_ptr<Stepper> make(const world::WorldModel& model, const std::string& name) {
  return std::make_unique<Mujoco>(model, name == "mujoco-rk4" ? "RK4" : "Euler");
}

}  // namespace

void add_mujoco(std::vector<StepperKind>& kinds) {
  kinds.push_back({"mujoco", takes, make});
  kinds.push_back({"mujoco-rk4", takes, make});
}

}  // namespace visum::bench
