// The messages about faults on purpose, as messages.h has the others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace visum::protocol {

// ---------------------------------------- client to server

struct FaultNumber {
  std::string name;
  double value = 0.0;
};
struct InjectFault {
  std::string part, kind;
  std::vector<FaultNumber> numbers;
  std::int64_t duration_ns = 0;
};
struct ClearFault {
  std::string part, kind;
  std::uint32_t joint = 0;
};
struct ListFaults {
  std::string part;
};

// ---------------------------------------- server to client

struct FaultNumberDescription {
  std::string name, unit;
  double minimum = 0.0, maximum = 0.0;
  bool needed = false;
  double usual = 0.0;
};
struct FaultKind {
  std::string name, target, effect;
  std::vector<FaultNumberDescription> numbers;
};
struct ActiveFault {
  std::string part, kind;
  std::vector<FaultNumber> numbers;
  std::int64_t until_tick = 0;
};
struct FaultList {
  std::vector<FaultKind> kinds;
  std::vector<ActiveFault> active;
};

}  // namespace visum::protocol
