// Where exceptions of the scene's readers and of engines become a refusal.
#pragma once

#include <exception>
#include <new>

#include "server/cycle/outcome.h"

namespace visum::cycle {

inline constexpr const char* kNoMemoryLeft =
    "not enough memory is left: the limit (ulimit -v, or the container's) is reached";

// Runs `change`, which throws where the scene, an engine or a sensor cannot bear what was asked for.
template <typename Change>
Outcome attempt(Refusal refusal, const Change& change) {
  try {
    change();
    return {};
  } catch (const std::bad_alloc&) {
    return {Refusal::kNoMemory, kNoMemoryLeft};
  } catch (const std::exception& error) {
    return {refusal, error.what()};
  }
}

}  // namespace visum::cycle
