// Messages about scenarios that a server runs beside its world, as plain values; visum.proto says what they
// mean.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace visum::protocol {

struct RunScenario {
  std::string name;
  std::int64_t timeout_ns = 0;
};
struct StopScenario {};
struct ReadScenario {};

enum class ScenarioVerdict : std::uint32_t { kUnspecified = 0, kPassed = 1, kFailed = 2, kInvalid = 3 };
const char* to_string(ScenarioVerdict verdict);  // "passed", ...

struct ScenarioCheck {
  std::string name;
  bool passed = false;
  std::string text{};
};
struct ScenarioState {
  std::string name{};
  bool running = false;
  ScenarioVerdict verdict = ScenarioVerdict::kUnspecified;
  std::int32_t exit_code = 0;
  std::string text{};
  std::vector<ScenarioCheck> checks{};
  std::uint64_t state_hash = 0;
};

}  // namespace visum::protocol
