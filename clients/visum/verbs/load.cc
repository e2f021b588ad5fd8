#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class LoadVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("SCENE", scene_, "a scene of the server, one of `visum scenes`")->required();
    add_link_options(app, link_, false);
    app.footer(
        "Begins a new era at time 0. Controllers stay connected, and lose their leases. Clock and speed stay "
        "as they are.\n\nExample:\n  visum load cart");
  }

  int run() override {
    open_link(link_, protocol::Role::kAdmin).request(protocol::LoadScene{scene_});
    return 0;
  }

 private:
  LinkOptions link_;
  std::string scene_;
};

}  // namespace

std::unique_ptr<Verb> make_load() {
  return std::make_unique<LoadVerb>();
}

}  // namespace visum::cli
