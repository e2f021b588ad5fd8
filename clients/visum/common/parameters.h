// Shows a part's parameters as text and JSON, and reads values for them.
#pragma once

#include <string>
#include <vector>

#include "clients/visum/common/json_writer.h"
#include "protocol/part_description.h"

namespace visum::cli {

std::string to_text(const protocol::ParameterValue& value);
std::string parameter_table(const std::vector<protocol::Parameter>& parameters);
void write_parameters(JsonWriter& json, const std::vector<protocol::Parameter>& parameters);

// `text` as a value of the parameter's own type. Throws ExitError(kUsage) that says what it takes.
protocol::ParameterValue parse_value(const protocol::Parameter& parameter, const std::string& text);

// The one of this name; throws ExitError(kUsage) with the nearest.
const protocol::Parameter& find_parameter(const std::string& part,
                                          const std::vector<protocol::Parameter>& parameters,
                                          const std::string& name);

}  // namespace visum::cli
