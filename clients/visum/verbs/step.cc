#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class StepVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("TICKS", ticks_, "how many ticks")
        ->capture_default_str()
        ->check(CLI::Range(std::int64_t{1}, kMost));
    add_link_options(app, link_);
    app.footer(
        "The world must be paused. Returns when the ticks are done.\n\nExample:\n  visum pause && visum step "
        "100");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kAdmin);
    const auto now = link.request_as<protocol::Advanced>(protocol::Step{ticks_});
    if (link_.json) {
      JsonWriter json;
      json.begin_object()
          .member("tick", now.tick)
          .member("sim_time_ns", now.sim_time_ns)
          .member("era", now.era);
      std::puts(json.end_object().text().c_str());
    } else {
      std::printf("tick %s, %s\n", std::to_string(now.tick).c_str(), seconds(now.sim_time_ns).c_str());
    }
    return 0;
  }

 private:
  static constexpr std::int64_t kMost = 1'000'000'000;

  LinkOptions link_;
  std::int64_t ticks_ = 1;
};

}  // namespace

std::unique_ptr<Verb> make_step() {
  return std::make_unique<StepVerb>();
}

}  // namespace visum::cli
