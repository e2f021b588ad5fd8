// The course of a run as lines of JSON on standard output, each written when it happens (`visum run
// --events`). SCENARIOS.md describes them; the server that runs a scenario for a client reads them. A line
// has at most 4096 bytes. Main thread.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "clients/visum/run/report.h"

namespace visum::run {

class EventLines {
 public:
  static void begin(const std::string& name, std::size_t runs, std::size_t checks);
  static void line(const std::string& who, const std::string& text);
  static void check(const CheckResult& check);
  static void end(const Report& report);

  // Tells of one run of a scenario that has several.
  static void run(const Report& report);
  static void end(std::span<const Report> reports, int code);
};

}  // namespace visum::run
