#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class ResetVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_, false);
    app.footer(
        "Time begins at 0 again, in a new era; controllers stay connected.\n\nExample:\n  visum reset");
  }

  int run() override {
    open_link(link_, protocol::Role::kAdmin).request(protocol::Reset{});
    return 0;
  }

 private:
  LinkOptions link_;
};

}  // namespace

std::unique_ptr<Verb> make_reset() {
  return std::make_unique<ResetVerb>();
}

}  // namespace visum::cli
