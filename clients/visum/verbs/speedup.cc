#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class SpeedupVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("FACTOR", factor_, "simulated seconds per second of wall time")
        ->required()
        ->check(number_within(1e-3, 1e3));
    add_link_options(app, link_, false);
    app.footer("Works with the clock realtime only.\n\nExample:\n  visum speedup 0.5");
  }

  int run() override {
    open_link(link_, protocol::Role::kAdmin).request(protocol::SetSpeed{factor_});
    return 0;
  }

 private:
  LinkOptions link_;
  double factor_ = 1.0;
};

}  // namespace

std::unique_ptr<Verb> make_speedup() {
  return std::make_unique<SpeedupVerb>();
}

}  // namespace visum::cli
