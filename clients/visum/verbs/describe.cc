#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/parameters.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

using protocol::PartDescription;
using protocol::Port;

void write_names(JsonWriter& json, const char* key, const std::vector<protocol::NumberName>& names) {
  if (names.empty()) return;
  json.key(key).begin_object();
  for (const auto& [number, name] : names) json.member(std::to_string(number).c_str(), name);
  json.end_object();
}

void write_ports(JsonWriter& json, const char* key, const std::vector<Port>& ports) {
  json.key(key).begin_array();
  std::size_t index = 0;
  for (const Port& port : ports) {
    json.begin_object().member("index", index++).member("name", port.name).member("group", port.group);
    json.member("unit", port.unit).member("minimum", port.minimum).member("maximum", port.maximum);
    json.member("initial", port.initial);
    write_names(json, "values", port.values);
    write_names(json, "bits", port.bits);
    json.end_object();
  }
  json.end_array();
}

std::string json_of(const protocol::PartDescriptionReply& reply) {
  const PartDescription& part = reply.description;
  JsonWriter json;
  json.begin_object()
      .member("name", part.name)
      .member("kind", part.kind)
      .member("lease_owner", reply.lease_owner);
  write_ports(json, "controller_inputs", part.controller_inputs);
  write_ports(json, "sensor_outputs", part.sensor_outputs);
  json.key("parameters");
  write_parameters(json, part.parameters);
  json.key("blackboards").begin_array();
  for (const auto& board : part.blackboards) {
    json.begin_object().member("name", board.name).member("content_type", board.content_type);
    json.member("element_size", board.element_size).member("elements", board.elements);
    json.member("capacity", board.capacity).member("writable", board.writable).end_object();
  }
  return json.end_array().end_object().text() + "\n";
}

std::string port_table(const std::vector<Port>& ports, bool inputs) {
  Table table;
  std::size_t index = 0;
  for (const Port& port : ports) {
    const std::string range = readable(port.minimum) + " .. " + readable(port.maximum);
    std::vector<std::string> row{std::to_string(index++), port.name, port.unit.empty() ? "-" : port.unit,
                                 range};
    if (inputs) row.push_back("initially " + readable(port.initial));
    table.row(row);
  }
  return table.text("  ");
}

// The names of a port's values or bits, one line for each group of ports.
std::string names_of_values(const std::vector<Port>& ports) {
  std::string text, last;
  for (const Port& port : ports) {
    if ((port.values.empty() && port.bits.empty()) || port.group == last) continue;
    last = port.group;
    std::string line = port.group + (port.values.empty() ? " bits:" : ":");
    for (const auto& [number, name] : port.values.empty() ? port.bits : port.values)
      line += " " + std::to_string(number) + " " + name + ",";
    line.pop_back();
    text += "  " + printable(line) + "\n";
  }
  return text;
}

std::string text_of(const protocol::PartDescriptionReply& reply) {
  const PartDescription& part = reply.description;
  std::string text = part.name + ": a part of kind " + part.kind + ", ";
  text = printable(text + (reply.lease_owner.empty() ? "free" : "leased by " + reply.lease_owner)) + "\n";
  text += "\nController Input\n" + port_table(part.controller_inputs, true) +
          names_of_values(part.controller_inputs);
  text += "\nSensor Output\n" + port_table(part.sensor_outputs, false) + names_of_values(part.sensor_outputs);
  if (!part.parameters.empty()) text += "\nParameters\n" + parameter_table(part.parameters);
  if (!part.blackboards.empty()) text += "\nBlackboards\n";
  Table boards;
  for (const auto& board : part.blackboards) {
    boards.row({board.name, board.content_type,
                std::to_string(board.elements) + " x " + std::to_string(board.element_size) + " bytes",
                board.writable ? "writable" : "read only"});
  }
  return text + boards.text("  ");
}

std::string names_of(const PartDescription& part) {
  std::string text;
  for (const Port& port : part.controller_inputs) text += printable(port.name) + "\n";
  for (const Port& port : part.sensor_outputs) text += printable(port.name) + "\n";
  return text;
}

class Describe : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "the part's name")->required();
    add_link_options(app, link_);
    app.add_flag("--names", names_only_, "print the ports' names alone, one a line");
    app.footer("Example:\n  visum describe arm");
  }

  int run() override {
    auto link = open_link(link_, protocol::Role::kObserver);
    const auto reply = describe_part(link, part_);
    std::fputs((link_.json    ? json_of(reply)
                : names_only_ ? names_of(reply.description)
                              : text_of(reply))
                   .c_str(),
               stdout);
    return 0;
  }

 private:
  LinkOptions link_;
  std::string part_;
  bool names_only_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_describe() {
  return std::make_unique<Describe>();
}

}  // namespace visum::cli
