#include <cstdio>

#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class PauseVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_, false);
    app.footer("Example:\n  visum pause");
  }

  int run() override {
    const auto done = open_link(link_, protocol::Role::kAdmin).request_as<protocol::Ok>(protocol::Pause{});
    if (done.acts_at_tick != 0)
      std::printf("latched: it acts at tick %lld, when the tick that the server is in has ended\n",
                  static_cast<long long>(done.acts_at_tick));
    return 0;
  }

 private:
  LinkOptions link_;
};

}  // namespace

std::unique_ptr<Verb> make_pause() {
  return std::make_unique<PauseVerb>();
}

}  // namespace visum::cli
