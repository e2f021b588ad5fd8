#include <cmath>

#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class PushVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("BODY", push_.body, "the body's name, e.g. box or arm/link_3")->required();
    app.add_option("FORCE", push_.force_n, "x y z in N, world frame")->required()->expected(3);
    app.add_option("--torque", push_.torque_nm, "x y z in Nm, world frame")->expected(3);
    app.add_option("--at", push_.point_m,
                   "x y z in m, world frame: the point that the force acts on; default: the centre of mass")
        ->expected(3);
    app.add_option("--for", duration_s_, "how long, in simulated seconds")
        ->capture_default_str()
        ->check(number_within(1e-9, 1e6));
    add_link_options(app, link_, false);
    app.footer("Example:\n  visum push box 0 0 5 --for 0.2");
  }

  int run() override {
    push_.duration_ns = std::llround(duration_s_ * 1e9);
    open_link(link_, protocol::Role::kAdmin).request(push_);
    return 0;
  }

 private:
  LinkOptions link_;
  protocol::PushBody push_;
  double duration_s_ = 0.1;
};

}  // namespace

std::unique_ptr<Verb> make_push() {
  return std::make_unique<PushVerb>();
}

}  // namespace visum::cli
