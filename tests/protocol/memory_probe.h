// Counts the memory that `operator new` hands out in this program, for tests that bound what an input may
// cost.
#pragma once

#include <cstddef>
#include <functional>

namespace visum::testing {

// The largest amount of memory, in bytes, that was allocated at any time during the call, beyond what was
// allocated before. For programs with one thread.
std::size_t most_allocated_during(const std::function<void()>& call);

}  // namespace visum::testing
