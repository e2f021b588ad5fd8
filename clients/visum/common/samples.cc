#include "clients/visum/common/samples.h"

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/terminal.h"

namespace visum::cli {

double value_of(const protocol::PartSample& sample, const PortRef& port) {
  const auto& values = port.output ? sample.sensor_outputs : sample.controller_inputs;
  if (port.index < values.size()) return values[port.index];
  throw ExitError(kFailed, "the server sent a sample without '" + port.port->name + "'");
}

std::string sample_table(const protocol::PartSample& sample, const std::vector<PortRef>& ports) {
  Table table;
  for (const PortRef& port : ports) {
    // A port without a unit may be a bit field such as a state word: a fixed number of digits would cut it.
    const double value = value_of(sample, port);
    const std::string words = protocol::in_words(*port.port, value);
    table.row({port.port->name, port.port->unit.empty() ? readable(value, 9) : fixed(value, 6),
               words.empty() ? port.port->unit : words});
  }
  return table.text();
}

std::string sample_json(const protocol::PartSample& sample, const std::vector<PortRef>& ports) {
  JsonWriter json;
  json.begin_object().member("part", sample.part).member("tick", sample.tick);
  json.member("sim_time_ns", sample.sim_time_ns).member("era", sample.era).key("ports").begin_object();
  for (const PortRef& port : ports) json.member(port.port->name, value_of(sample, port));
  json.end_object();
  // The same values in words, where their ports have names for them.
  bool has_words = false;
  for (const PortRef& port : ports) {
    const std::string words = protocol::in_words(*port.port, value_of(sample, port));
    if (words.empty()) continue;
    if (!has_words) json.key("words").begin_object();
    has_words = true;
    json.member(port.port->name, words);
  }
  if (has_words) json.end_object();
  return json.end_object().text();
}

std::string sample_line(const protocol::PartSample& sample, const std::vector<PortRef>& ports) {
  std::string line = seconds(sample.sim_time_ns);
  for (const PortRef& port : ports) {
    line += "  " + port.port->name + "=" + readable(value_of(sample, port), 9);
    if (!port.port->unit.empty()) line += " " + port.port->unit;
    const std::string words = protocol::in_words(*port.port, value_of(sample, port));
    if (!words.empty()) line += " (" + printable(words) + ")";
  }
  return line;
}

}  // namespace visum::cli
