// Which call of a plug-in's code this process is in, so that a watchdog on another thread can tell of one
// that does not come back. There is one such call at most: all of a process's plug-ins live on one thread.
#pragma once

#include <cstdint>

namespace visum::plugin {

// Stands while plug-in code runs; may stand within another one.
class ForeignCall {
 public:
  // `node`: "agent 'explorer'"; must outlive this by far (foreign_node).
  explicit ForeignCall(const char* node);
  ~ForeignCall();
  ForeignCall(const ForeignCall&) = delete;
  ForeignCall& operator=(const ForeignCall&) = delete;

 private:
  const char* outer_;
};

// For the watchdog: changes with every call that begins or ends.
std::uint64_t foreign_calls();
// The node of the call that stands; null: none. May be looked into only once foreign_calls() has not changed
// for far longer than a call takes.
const char* foreign_node();

}  // namespace visum::plugin
