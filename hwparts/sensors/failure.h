// The ways in which a sensor fails, in PX4's words (its failure injection).
#pragma once

#include <span>
#include <string>

#include "hwparts/fault_kinds.h"

namespace visum::sensors {

enum class Failure {
  kOk,
  kOff,           // no readings: the ports stand still, and so does `Changed`
  kStuck,         // shows the last reading again and again
  kGarbage,       // shows random values within the range
  kWrong,         // mirrors each value in its range, as if wired the wrong way round
  kSlow,          // shows one reading of ten
  kDelayed,       // shows readings ten samples later than usual
  kIntermittent,  // loses each reading with a chance of one half
};

inline constexpr int kSlowFactor = 10;
inline constexpr int kDelayedSamples = 10;
inline constexpr double kLossChance = 0.5;

struct FailureName {
  Failure failure;
  const char* name;
};
std::span<const FailureName> failure_names();
const char* name_of(Failure failure);
bool is_failure(Failure failure);             // for a number that was read from a snapshot
Failure failure_of(hwparts::FaultKind kind);  // kOk: the fault does not concern sensors

}  // namespace visum::sensors
