// Counts what `operator new` hands out in this program, for tests that bound the memory that an input can
// cost.
#pragma once

#include <cstddef>
#include <functional>

namespace visum::testing {

// The most bytes that were allocated at once, beyond what was there before. One thread.
std::size_t most_allocated_during(const std::function<void()>& call);

}  // namespace visum::testing
