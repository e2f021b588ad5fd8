#include <chrono>
#include <cmath>
#include <thread>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/numbers.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class PullVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("BODY", pull_.body, "the body's name, e.g. box or arm/link_3")->required();
    app.add_option("POINT", point_, "the point that is pulled, m, in the body's link frame")
        ->required()
        ->type_name("X,Y,Z");
    app.add_option("--to", target_, "where the point is pulled to, m, world frame")
        ->required()
        ->type_name("X,Y,Z");
    app.add_option("--max-force", pull_.max_force_n, "the greatest force, N")
        ->required()
        ->check(number_within(1e-6, 1e6));
    app.add_option("--seconds", duration_s_, "how long, in simulated seconds")
        ->required()
        ->check(number_within(1e-9, 3600));
    add_link_options(app, link_, false);
    app.footer(
        "A spring with a damper pulls: a free body comes to rest at the target within about 0.3 s, as far as "
        "the force and the things around it allow. The pull ends with this program, also by Ctrl-C.\n\n"
        "Example:\n  visum pull box 0,0,0 --to 0.5,0.2,0.8 --max-force 20 --seconds 2");
  }

  int run() override {
    pull_.point_m = parse_numbers(point_, 3, 3, "X,Y,Z");
    pull_.target_m = parse_numbers(target_, 3, 3, "X,Y,Z");
    pull_.duration_ns = std::llround(duration_s_ * 1e9);
    auto link = open_link(link_, protocol::Role::kAdmin);
    const auto status = [&] { return link.request_as<protocol::ServerStatus>(protocol::Status{}); };
    catch_interrupts();
    link.request(pull_);
    const auto begin = status();
    for (auto now = begin; now.sim_time_ns - begin.sim_time_ns < pull_.duration_ns; now = status()) {
      if (now.era != begin.era)
        throw ExitError(kFailed, "the world was reset or restored, which ends the pull");
      if (now.frozen) throw ExitError(kFailed, "the world is frozen: " + now.frozen_reason);
      if (interrupted()) return kInterrupted;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return kDone;
  }

 private:
  LinkOptions link_;
  protocol::PullBody pull_;
  std::string point_, target_;
  double duration_s_ = 0.0;
};

}  // namespace

std::unique_ptr<Verb> make_pull() {
  return std::make_unique<PullVerb>();
}

}  // namespace visum::cli
