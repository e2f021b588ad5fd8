#include <map>

#include "clients/visum/verbs/verbs.h"
#include "protocol/command_line/one_of.h"

namespace visum::cli {
namespace {

using protocol::ResetScope;

const std::map<std::string, ResetScope> kScopes{{"world", ResetScope::kWorld},
                                                {"time", ResetScope::kTime},
                                                {"state", ResetScope::kState},
                                                {"spawned", ResetScope::kSpawned},
                                                {"all", ResetScope::kAll}};

class ResetVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option(
           "--scope", scope_,
           "world: time and state; time: it begins at 0, all else goes on; state: bodies, joints and "
           "parts as in the beginning, time goes on; spawned: what came goes, what went is back; all: "
           "the scene as it was loaded")
        ->capture_default_str()
        ->check(command_line::one_of({"world", "time", "state", "spawned", "all"}));
    add_link_options(app, link_, false);
    app.footer(
        "Controllers stay connected. All scopes but spawned begin a new era.\n\nExamples:\n  visum reset\n  "
        "visum reset --scope all");
  }

  int run() override {
    open_link(link_, protocol::Role::kAdmin).request(protocol::Reset{kScopes.at(scope_)});
    return 0;
  }

 private:
  LinkOptions link_;
  std::string scope_ = "world";
};

}  // namespace

std::unique_ptr<Verb> make_reset() {
  return std::make_unique<ResetVerb>();
}

}  // namespace visum::cli
