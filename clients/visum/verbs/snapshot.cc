#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class SnapshotVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("--name", name_,
                   "also keep it on the server's disk (visumd --files) under this name, which begins with a "
                   "letter");
    add_link_options(app, link_);
    app.footer(
        "Prints the snapshot's number. The server keeps the newest snapshots in memory; one with a name also "
        "outlives the server.\n\nExamples:\n  visum restore $(visum snapshot)\n  visum snapshot --name "
        "gripped");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kAdmin);
    const auto taken = link.request_as<protocol::SnapshotTaken>(protocol::TakeSnapshot{name_});
    if (link_.json) {
      JsonWriter json;
      json.begin_object().member("snapshot", taken.snapshot).member("tick", taken.tick);
      std::puts(json.member("state_hash", hex(taken.state_hash)).end_object().text().c_str());
    } else {
      std::puts(std::to_string(taken.snapshot).c_str());
    }
    return 0;
  }

 private:
  LinkOptions link_;
  std::string name_;
};

}  // namespace

std::unique_ptr<Verb> make_snapshot() {
  return std::make_unique<SnapshotVerb>();
}

}  // namespace visum::cli
