#include <algorithm>
#include <charconv>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class RestoreVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("SNAPSHOT", snapshot_,
                   "its number, as `visum snapshot` printed it, or the name of one that is kept on disk")
        ->required();
    add_link_options(app, link_, false);
    app.footer("Examples:\n  visum restore 1\n  visum restore gripped");
  }

  int run() override {
    protocol::RestoreSnapshot request;
    if (std::ranges::all_of(snapshot_, [](char c) { return c >= '0' && c <= '9'; })) {
      const auto [end, error] =
          std::from_chars(snapshot_.data(), snapshot_.data() + snapshot_.size(), request.snapshot);
      if (error != std::errc{}) throw ExitError(kUsage, "there is no snapshot " + snapshot_);
    } else {
      request.name = snapshot_;
    }
    open_link(link_, protocol::Role::kAdmin).request(request);
    return 0;
  }

 private:
  LinkOptions link_;
  std::string snapshot_;
};

}  // namespace

std::unique_ptr<Verb> make_restore() {
  return std::make_unique<RestoreVerb>();
}

}  // namespace visum::cli
