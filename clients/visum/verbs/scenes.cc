#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class ScenesVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_);
    app.footer("Example:\n  visum scenes");
  }

  int run() override {
    const auto list =
        open_link(link_, protocol::Role::kObserver).request_as<protocol::SceneList>(protocol::ListScenes{});
    if (link_.json) {
      JsonWriter json;
      json.begin_object().member("scenes", list.scenes).member("scenarios", list.scenarios);
      std::printf("%s\n", json.end_object().text().c_str());
      return 0;
    }
    Table table;
    for (const auto& scene : list.scenes) table.row({"scene", scene});
    for (const auto& scenario : list.scenarios) table.row({"scenario", scenario});
    std::fputs(table.text().c_str(), stdout);
    return 0;
  }

 private:
  LinkOptions link_;
};

}  // namespace

std::unique_ptr<Verb> make_scenes() {
  return std::make_unique<ScenesVerb>();
}

}  // namespace visum::cli
