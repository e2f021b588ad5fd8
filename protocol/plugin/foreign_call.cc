#include "protocol/plugin/foreign_call.h"

#include <atomic>

namespace visum::plugin {
namespace {

std::atomic<const char*> standing_node{nullptr};
std::atomic<std::uint64_t> calls{0};

// Only one thread writes, so a plain load and store suffice and need no lock.
void put(const char* node) {
  standing_node.store(node, std::memory_order_release);
  calls.store(calls.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

}  // namespace

ForeignCall::ForeignCall(const char* node) : outer_(standing_node.load(std::memory_order_relaxed)) {
  put(node);
}

ForeignCall::~ForeignCall() {
  put(outer_);
}

std::uint64_t foreign_calls() {
  return calls.load(std::memory_order_acquire);
}

const char* foreign_node() {
  return standing_node.load(std::memory_order_acquire);
}

}  // namespace visum::plugin
