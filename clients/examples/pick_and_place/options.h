// The program's command line.
#pragma once

#include <string>

#include "clients/examples/pick_and_place/plan.h"

namespace visum::pick_and_place {

struct Options {
  std::string connect = "127.0.0.1:1500";
  std::string part = "arm";
  std::string urdf;
  std::string token_file;
  double speed = 0.9;         // share of the drives' maximum speeds
  double acceleration = 0.8;  // rad/s²
  Job job;
};

// The program is done if `exit_code` is not negative: help was shown, or the usage was wrong.
struct ParsedOptions {
  Options options;
  int exit_code = -1;
};
ParsedOptions parse_options(int argc, const char* const* argv);

}  // namespace visum::pick_and_place
