// The scope of a reset in words, for events.
#pragma once

#include "protocol/reset_scope.h"

namespace visum::protocol {

inline const char* in_words(ResetScope scope) {
  switch (scope) {
    case ResetScope::kWorld:
      return "time and state";
    case ResetScope::kTime:
      return "time";
    case ResetScope::kState:
      return "state";
    case ResetScope::kSpawned:
      return "what was spawned";
    case ResetScope::kAll:
      return "all";
  }
  return "all";
}

}  // namespace visum::protocol
