#include "clients/visum/common/numbers.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class PoseVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("BODY", set_.body, "the body's name, e.g. box")->required();
    app.add_option("POSE", pose_,
                   "where its link frame goes: m, and rad about the fixed axes x, y, z; without angles it "
                   "keeps its direction")
        ->required()
        ->type_name("X,Y,Z[,R,P,Y]");
    app.add_option("--velocity", velocity_,
                   "of the link frame's origin, m/s, and turn rate, rad/s, world frame; default: at rest")
        ->type_name("VX,VY,VZ[,WX,WY,WZ]");
    add_link_options(app, link_, false);
    app.footer(
        "All that hangs on the body goes along. A kinematic body goes on with its velocity until it is set "
        "again.\n\nExamples:\n  visum pose box 0.6,0,0.5\n  visum pose door 1,0,0 --velocity 0,0,0,0,0,0.5");
  }

  int run() override {
    bool turned = false;
    set_.pose = parse_pose(pose_, turned);
    if (!velocity_.empty()) set_.velocity = parse_numbers(velocity_, 3, 6, "VX,VY,VZ or VX,VY,VZ,WX,WY,WZ");
    if (!velocity_.empty()) set_.velocity.resize(6);
    set_.keeps_moving = true;
    auto link = open_link(link_, protocol::Role::kAdmin);
    if (!turned) keep_direction(link);
    link.request(set_);
    return 0;
  }

 private:
  void keep_direction(protocol::Connection& link) {
    const auto world = link.request_as<protocol::WorldDescription>(protocol::DescribeWorld{});
    const auto now = link.request_as<protocol::WorldSample>(protocol::ReadWorld{});
    for (std::size_t i = 0; i < world.bodies.size() && 7 * i + 6 < now.poses.size(); ++i)
      if (world.bodies[i].name == set_.body)
        for (std::size_t k = 3; k < 7; ++k) set_.pose[k] = now.poses[7 * i + k];
  }

  LinkOptions link_;
  protocol::SetBody set_;
  std::string pose_, velocity_;
};

}  // namespace

std::unique_ptr<Verb> make_pose() {
  return std::make_unique<PoseVerb>();
}

}  // namespace visum::cli
