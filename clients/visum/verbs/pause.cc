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
    open_link(link_, protocol::Role::kAdmin).request(protocol::Pause{});
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
