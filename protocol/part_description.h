// What a hardware part has to offer: its ports, parameters and blackboards, in the order that is its
// contract. Plain values; the wire form is PartDescription in visum.proto, translated in protocol/wire.h.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace visum::protocol {

// One number of a part. Its index in the vector is the contract; saved panels refer to it.
struct Port {
  std::string name;  // natural form, "Desired Angle 1"
  std::string unit;  // "rad", "rad/s", "m", "m/s", "A"; empty for counters and bit fields
  double minimum;    // a value outside [minimum, maximum] is refused
  double maximum;
  double initial;     // controller inputs: value until somebody writes
  std::string group;  // the ports that belong together, "Desired Angle"
};

using ParameterValue = std::variant<double, std::int64_t, bool, std::string>;

// A named, typed setting of a part that can be changed while it runs.
struct Parameter {
  std::string name;
  std::string unit;
  std::string help;
  ParameterValue value;  // as it was when described
  double minimum = 0.0;  // numbers and integers
  double maximum = 0.0;
  std::vector<std::string> choices;  // texts; empty: any
  bool read_only = false;
};

// A named block of bytes beside the ports.
struct Blackboard {
  std::string name;
  std::string content_type;  // "text/plain", "image/x-rgb24", ...
  std::uint64_t element_size = 1;
  std::uint64_t elements = 0;
  std::uint64_t capacity = 0;
  bool writable = false;
};

struct PartDescription {
  std::string name;  // in the scene, "arm"
  std::string kind;  // "amtec_arm"
  std::vector<Port> controller_inputs;
  std::vector<Port> sensor_outputs;
  std::vector<Parameter> parameters;
  std::vector<Blackboard> blackboards;
};

}  // namespace visum::protocol
