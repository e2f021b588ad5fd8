// The counts of one thread's scope, and the decision from a call stack who allocated. Inner header of
// allocation_counter.
#pragma once

#include <array>
#include <cstddef>

#include "tests/support/allocation_counter.h"

namespace visum::test_support {

inline constexpr int kMaxFrames = 48;
inline constexpr std::size_t kMaxStacks = 4;

struct Stack {
  std::array<void*, kMaxFrames> frames{};
  int count = 0;
};

// Has constant initialisation and constant size, because the counting itself must not allocate.
struct AllocationRecord {
  bool counting = false;
  bool busy = false;  // inside the counter, whose own calls do not count
  AllocationCounts counts;
  std::array<Stack, kMaxStacks> stacks{};  // of our allocations
  std::size_t stack_count = 0;
};
AllocationRecord& allocation_record();  // of this thread

// Called after each allocation of this thread by the code that watches the allocator.
void note_allocation(std::size_t bytes);

bool is_foreign(const Stack& stack);

}  // namespace visum::test_support
