#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class ResumeVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_, false);
    app.footer("Example:\n  visum resume");
  }

  int run() override {
    open_link(link_, protocol::Role::kAdmin).request(protocol::Resume{});
    return 0;
  }

 private:
  LinkOptions link_;
};

}  // namespace

std::unique_ptr<Verb> make_resume() {
  return std::make_unique<ResumeVerb>();
}

}  // namespace visum::cli
