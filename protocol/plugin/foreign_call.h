// Records which call into a plug-in's code this process is in. A watchdog on another thread uses it to find a
// call that does not come back. One record is enough, because all plug-ins of a process run on one thread.
#pragma once

#include <cstdint>

namespace visum::plugin {

// Lives on the stack while plug-in code runs. Calls may be nested.
class ForeignCall {
 public:
  // `node`: "agent 'explorer'". The text must outlive this object by far: the watchdog may still read it.
  explicit ForeignCall(const char* node);
  ~ForeignCall();
  ForeignCall(const ForeignCall&) = delete;
  ForeignCall& operator=(const ForeignCall&) = delete;

 private:
  const char* outer_;
};

// For the watchdog: this number changes with every call that begins or ends.
std::uint64_t foreign_calls();
// The node that is being called; null if none is. Read the text only if foreign_calls() has not changed for
// far longer than a call takes.
const char* foreign_node();

}  // namespace visum::plugin
