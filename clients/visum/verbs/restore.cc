#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class RestoreVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("SNAPSHOT", snapshot_, "its number, as `visum snapshot` printed it")->required();
    add_link_options(app, link_, false);
    app.footer("Example:\n  visum restore 1");
  }

  int run() override {
    open_link(link_, protocol::Role::kAdmin).request(protocol::RestoreSnapshot{snapshot_});
    return 0;
  }

 private:
  LinkOptions link_;
  std::uint64_t snapshot_ = 0;
};

}  // namespace

std::unique_ptr<Verb> make_restore() {
  return std::make_unique<RestoreVerb>();
}

}  // namespace visum::cli
