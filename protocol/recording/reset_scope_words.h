// The scope of a reset in words, for events.
#pragma once

#include "protocol/reset_scope.h"

namespace visum::recording {

inline const char* in_words(protocol::ResetScope scope) {
  using protocol::ResetScope;
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

}  // namespace visum::recording
