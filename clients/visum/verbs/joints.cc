#include <algorithm>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/numbers.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

constexpr const char* kExample = "joint_1=0.5";

class JointsVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("MODEL", set_.model, "the model's name, e.g. arm")->required();
    app.add_option("JOINTS", joints_, "where its joints go, rad or m; the others stay")
        ->required()
        ->type_name("NAME=VALUE");
    app.add_option("--velocity", velocities_, "velocities, rad/s or m/s; default: at rest")
        ->type_name("NAME=VALUE");
    add_link_options(app, link_, false);
    app.footer(
        "The joints are there at once; no drive moves them. Drives stand where they are put until they get a "
        "new command. A joint of a kinematic model goes on with its velocity until it is set "
        "again.\n\nExample:\n  visum joints arm joint_1=0.5 joint_2=-0.3");
  }

  int run() override {
    for (const auto& word : joints_) {
      const auto [name, position] = parse_named_number(word, kExample);
      set_.joints.push_back({name, position, 0.0});
    }
    for (const auto& word : velocities_) {
      const auto [name, velocity] = parse_named_number(word, kExample);
      const auto joint = std::ranges::find(set_.joints, name, &protocol::JointTarget::name);
      if (joint == set_.joints.end())
        throw ExitError(kUsage, "--velocity " + word + ": give the joint a position as well");
      joint->velocity = velocity;
    }
    set_.keeps_moving = true;
    open_link(link_, protocol::Role::kAdmin).request(set_);
    return 0;
  }

 private:
  LinkOptions link_;
  protocol::SetJoints set_;
  std::vector<std::string> joints_, velocities_;
};

}  // namespace

std::unique_ptr<Verb> make_joints() {
  return std::make_unique<JointsVerb>();
}

}  // namespace visum::cli
