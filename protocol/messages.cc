#include "protocol/messages.h"

namespace visum::protocol {

const char* to_string(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUnspecified:
      return "unspecified";
    case ErrorCode::kMalformed:
      return "malformed";
    case ErrorCode::kTooLarge:
      return "too large";
    case ErrorCode::kVersion:
      return "version";
    case ErrorCode::kUnauthenticated:
      return "unauthenticated";
    case ErrorCode::kForbidden:
      return "forbidden";
    case ErrorCode::kBusy:
      return "busy";
    case ErrorCode::kUnknownName:
      return "unknown name";
    case ErrorCode::kNoLease:
      return "no lease";
    case ErrorCode::kLeased:
      return "leased";
    case ErrorCode::kBadValue:
      return "bad value";
    case ErrorCode::kStale:
      return "stale";
    case ErrorCode::kWrongState:
      return "wrong state";
    case ErrorCode::kTimeout:
      return "timeout";
    case ErrorCode::kFrozen:
      return "frozen";
    case ErrorCode::kInternal:
      return "internal";
  }
  return "unknown";
}

const char* to_string(Role role) {
  switch (role) {
    case Role::kUnspecified:
      return "unspecified";
    case Role::kObserver:
      return "observer";
    case Role::kController:
      return "controller";
    case Role::kAdmin:
      return "admin";
  }
  return "unknown";
}

const char* to_string(EventLevel level) {
  switch (level) {
    case EventLevel::kUnspecified:
    case EventLevel::kInfo:
      return "info";
    case EventLevel::kDebug:
      return "debug";
    case EventLevel::kWarning:
      return "warning";
    case EventLevel::kError:
      return "error";
  }
  return "info";
}

const char* to_string(ScenarioVerdict verdict) {
  switch (verdict) {
    case ScenarioVerdict::kUnspecified:
      return "unknown";
    case ScenarioVerdict::kPassed:
      return "passed";
    case ScenarioVerdict::kFailed:
      return "failed";
    case ScenarioVerdict::kInvalid:
      return "invalid";
  }
  return "unknown";
}

const char* to_string(ModuleVector vector) {
  switch (vector) {
    case ModuleVector::kUnspecified:
      return "no vector";
    case ModuleVector::kControllerInput:
      return "Controller Input";
    case ModuleVector::kControllerOutput:
      return "Controller Output";
    case ModuleVector::kSensorInput:
      return "Sensor Input";
    case ModuleVector::kSensorOutput:
      return "Sensor Output";
  }
  return "no vector";
}

}  // namespace visum::protocol
