#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

// "joint, share=1"
std::string numbers_of(const protocol::FaultKind& kind) {
  std::string all;
  for (const auto& number : kind.numbers) {
    all += (all.empty() ? "" : ", ") + number.name;
    if (!number.needed) all += "=" + exact(number.usual);
  }
  return all.empty() ? "-" : all;
}

std::string in_words(const protocol::ActiveFault& fault) {
  std::string words = fault.part + ": " + fault.kind;
  for (const auto& number : fault.numbers) words += " " + number.name + "=" + exact(number.value);
  return words + (fault.until_tick == 0 ? "" : ", until tick " + std::to_string(fault.until_tick));
}

class Faults : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "only the faults that this part knows");
    add_link_options(app, link_);
    app.footer(
        "Prints each kind of fault: its name, what it breaks, its numbers (those without = must be given), "
        "and how it "
        "shows. Then prints the faults that act now.\n\nExample:\n  visum faults arm");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kObserver);
    const auto list = link.request_as<protocol::FaultList>(protocol::ListFaults{part_});
    std::fputs((link_.json ? json(list) : text(list)).c_str(), stdout);
    return 0;
  }

 private:
  static std::string text(const protocol::FaultList& list) {
    Table table;
    for (const auto& kind : list.kinds) table.row({kind.name, kind.target, numbers_of(kind), kind.effect});
    std::string text = table.text() + "\n";
    for (const auto& fault : list.active) text += "acts on " + printable(in_words(fault)) + "\n";
    return text + (list.active.empty() ? "no fault acts now\n" : "");
  }

  static std::string json(const protocol::FaultList& list) {
    JsonWriter json;
    json.begin_object().key("kinds").begin_array();
    for (const auto& kind : list.kinds) write(json, kind);
    json.end_array().key("active").begin_array();
    for (const auto& fault : list.active) write(json, fault);
    return json.end_array().end_object().text() + "\n";
  }

  static void write(JsonWriter& json, const protocol::FaultKind& kind) {
    json.begin_object().member("name", kind.name).member("target", kind.target).member("effect", kind.effect);
    json.key("numbers").begin_array();
    for (const auto& number : kind.numbers) {
      json.begin_object().member("name", number.name).member("unit", number.unit);
      json.member("minimum", number.minimum).member("maximum", number.maximum).key("usual");
      if (number.needed)
        json.null();
      else
        json.value(number.usual);
      json.end_object();
    }
    json.end_array().end_object();
  }

  static void write(JsonWriter& json, const protocol::ActiveFault& fault) {
    json.begin_object().member("part", fault.part).member("kind", fault.kind).key("numbers").begin_object();
    for (const auto& number : fault.numbers) json.member(number.name, number.value);
    json.end_object().member("until_tick", fault.until_tick).end_object();
  }

  LinkOptions link_;
  std::string part_;
};

}  // namespace

std::unique_ptr<Verb> make_faults() {
  return std::make_unique<Faults>();
}

}  // namespace visum::cli
