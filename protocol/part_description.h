// Describes what a hardware part offers: its ports, parameters and blackboards, in the order that its
// contract fixes. Plain values. On the wire this is PartDescription of visum.proto, translated in
// protocol/wire_part.cc.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace visum::protocol {

// The name of a port's value, or of one of its bits (counted from 0).
struct NumberName {
  std::int64_t number;
  std::string name;
};

// One number of a part. Its index in the vector is part of the contract: writes and saved panels refer to it.
struct Port {
  std::string name;  // as people write it, "Desired Angle 1"
  std::string unit;  // "rad", "rad/s", "m", "m/s", "A"; empty for counters and bit fields
  double minimum;    // a value outside [minimum, maximum] is refused
  double maximum;
  double initial;                       // controller inputs: the value until the first write
  std::string group;                    // shared by ports that belong together, "Desired Angle"
  std::vector<NumberName> values = {};  // a port with a list of values: what each means
  std::vector<NumberName> bits = {};    // a bit field: what each bit means
};

// The port's value in words: the name of the value, or the names of the bits that are set, "HOME_OK MOTION".
// A bit without a name is "bit 7". Empty where the port has no names, or none for this value.
std::string in_words(const Port& port, double value);

using ParameterValue = std::variant<double, std::int64_t, bool, std::string>;

// A setting of a part, with a name and a type, that can be changed while the part runs.
struct Parameter {
  std::string name;
  std::string unit;
  std::string help;
  ParameterValue value;  // at the time of the description
  double minimum = 0.0;  // for numbers and integers
  double maximum = 0.0;
  std::vector<std::string> choices;  // for texts; empty: any text
  bool read_only = false;
};

// The parameter that takes the supply from all motors of a part, where the part has one. Every client may set
// it to true.
inline constexpr const char* kEmergencyStop = "Emergency Stop";

// The parameter that says in words which drives of a part are in fault, why, and what to try: a line each.
// Empty: none is. Read-only.
inline constexpr const char* kTripped = "Tripped";

// The value as a person would type it: 0.1, true, slow.
std::string value_text(const ParameterValue& value);

// Returns why the parameter cannot take the value; empty: it can. A whole number becomes a number where the
// parameter is one. `read_only` is not looked at.
std::string refuse_value(const Parameter& parameter, ParameterValue& value);

// A block of bytes beside the ports, with a name.
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
