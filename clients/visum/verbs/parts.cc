#include <algorithm>
#include <cstdio>
#include <sstream>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

// A part of the list, with its state in words where it shows one, and the drives that are in fault.
struct Shown {
  protocol::PartSummary part;
  std::string state, tripped;
};

std::string text_of(const std::vector<protocol::Parameter>& parameters, const char* name) {
  const auto found = std::ranges::find(parameters, name, &protocol::Parameter::name);
  const auto* text = found == parameters.end() ? nullptr : std::get_if<std::string>(&found->value);
  return text ? *text : "";
}

Shown look(protocol::Connection& link, const protocol::PartSummary& part) {
  Shown shown{part, "", ""};
  const auto description = describe_part(link, part.name).description;
  const auto& outputs = description.sensor_outputs;
  const auto port = std::ranges::find(outputs, "Part State", &protocol::Port::name);
  if (port == outputs.end()) return shown;
  const auto sample = link.request_as<protocol::PartSample>(protocol::Read{part.name});
  const auto index = static_cast<std::size_t>(port - outputs.begin());
  if (index < sample.sensor_outputs.size())
    shown.state = protocol::in_words(*port, sample.sensor_outputs[index]);
  shown.tripped =
      text_of(link.request_as<protocol::ParameterList>(protocol::GetParameters{part.name}).parameters,
              protocol::kTripped);
  return shown;
}

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
    if (names_only_ && !link_.json) {
      std::fputs(names(list).c_str(), stdout);
      return 0;
    }
    std::vector<Shown> parts;
    for (const auto& part : list.parts) parts.push_back(look(link, part));
    std::fputs((link_.json ? json(parts) : text(parts)).c_str(), stdout);
    return 0;
  }

 private:
  static std::string json(const std::vector<Shown>& parts) {
    JsonWriter json;
    json.begin_object().key("parts").begin_array();
    for (const auto& [part, state, tripped] : parts) {
      json.begin_object().member("name", part.name).member("kind", part.kind);
      json.member("lease_owner", part.lease_owner);
      if (!state.empty()) json.member("state", state).member("tripped", tripped);
      json.end_object();
    }
    return json.end_array().end_object().text() + "\n";
  }

  static std::string names(const protocol::PartList& list) {
    std::string text;
    for (const auto& part : list.parts) text += printable(part.name) + "\n";
    return text;
  }

  static std::string text(const std::vector<Shown>& parts) {
    Table table;
    std::string trips;
    for (const auto& [part, state, tripped] : parts) {
      table.row(
          {part.name, part.kind, part.lease_owner.empty() ? "free" : "leased by " + part.lease_owner, state});
      std::istringstream lines(tripped);
      for (std::string line; std::getline(lines, line);) trips += printable(part.name + ": " + line) + "\n";
    }
    return table.text() + trips;
  }

  LinkOptions link_;
  bool names_only_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_parts() {
  return std::make_unique<Parts>();
}

}  // namespace visum::cli
