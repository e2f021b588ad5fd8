// A check for options whose value is one word of a few.
#pragma once

#include <CLI/Validators.hpp>
#include <string>
#include <vector>

namespace visum::command_line {

// "must be one of realtime, lockstep, free, is 'realtme'; did you mean 'realtime'?". --help shows the
// choices.
CLI::Validator one_of(const std::vector<std::string>& choices);

}  // namespace visum::command_line
