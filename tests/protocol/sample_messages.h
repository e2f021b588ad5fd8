// One message of each kind with every field filled, for round trips, conformance vectors and the fuzzer's
// seeds. No field holds its default.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "protocol/messages.h"

namespace visum::testing {

template <typename Message>
using Samples = std::vector<std::pair<std::string, Message>>;  // name of the vector, "set_parameter_text"

Samples<protocol::Request> sample_requests();
Samples<protocol::Reply> sample_replies();

}  // namespace visum::testing
