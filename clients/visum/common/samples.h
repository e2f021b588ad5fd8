// Shows a sample of a part as text and JSON.
#pragma once

#include <string>
#include <vector>

#include "clients/visum/common/ports.h"
#include "protocol/messages.h"

namespace visum::cli {

// Throws ExitError(kFailed) if the sample is shorter than the part's description says.
double value_of(const protocol::PartSample& sample, const PortRef& port);

std::string sample_table(const protocol::PartSample& sample, const std::vector<PortRef>& ports);
// {"part":"arm","tick":1,"sim_time_ns":1000000,"era":0,"ports":{"Actual Angle 1":0.5}}, without a line's end.
std::string sample_json(const protocol::PartSample& sample, const std::vector<PortRef>& ports);
// "1.250 s  Actual Angle 1=0.5 rad  ...", without a line's end.
std::string sample_line(const protocol::PartSample& sample, const std::vector<PortRef>& ports);

}  // namespace visum::cli
