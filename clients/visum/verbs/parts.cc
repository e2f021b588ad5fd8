#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class Parts : public Verb {
 public:
  void declare(CLI::App& app) override {
    add_link_options(app, link_);
    app.add_flag("--names", names_only_, "print the names alone, one a line");
    app.footer("Example:\n  visum parts --connect 127.0.0.1:1500");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kObserver);
    const auto list = link.request_as<protocol::PartList>(protocol::ListParts{});
    std::fputs((link_.json ? json(list) : names_only_ ? names(list) : text(list)).c_str(), stdout);
    return 0;
  }

 private:
  static std::string json(const protocol::PartList& list) {
    JsonWriter json;
    json.begin_object().key("parts").begin_array();
    for (const auto& part : list.parts) {
      json.begin_object().member("name", part.name).member("kind", part.kind);
      json.member("lease_owner", part.lease_owner).end_object();
    }
    return json.end_array().end_object().text() + "\n";
  }

  static std::string names(const protocol::PartList& list) {
    std::string text;
    for (const auto& part : list.parts) text += printable(part.name) + "\n";
    return text;
  }

  static std::string text(const protocol::PartList& list) {
    Table table;
    for (const auto& part : list.parts) {
      table.row({part.name, part.kind, part.lease_owner.empty() ? "free" : "leased by " + part.lease_owner});
    }
    return table.text();
  }

  LinkOptions link_;
  bool names_only_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_parts() {
  return std::make_unique<Parts>();
}

}  // namespace visum::cli
