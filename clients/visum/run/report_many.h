// Many runs for people, and as lines of JSON for scripts.
#pragma once

#include <span>
#include <string>

#include "clients/visum/common/terminal.h"
#include "clients/visum/run/report.h"

namespace visum::run {

// "passed  run 3: payload=2, seed=1  4 of 4 checks, 9f3c0a5be2d81746"; of one that failed, why.
std::string run_line(const Report& report, const cli::Style& style);
std::string many_text(std::span<const Report> reports, double wall_seconds, const cli::Style& style);

// {"run":3,"sweep":{"payload":"2"},"passed":true,"code":0,"ticks":...,"state_hash":"..."}
std::string run_json(const Report& report);
// {"passed":false,"runs":12,"failed":3,"wall_seconds":4.2}
std::string many_json(std::span<const Report> reports, double wall_seconds);

}  // namespace visum::run
