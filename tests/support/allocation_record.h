// What one thread's scope has seen, and how a call stack tells whose an allocation is. Inside of
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

// Constant-initialised and of constant size: the counting itself must not allocate.
struct AllocationRecord {
  bool counting = false;
  bool busy = false;  // inside the counter: what it calls does not count
  AllocationCounts counts;
  std::array<Stack, kMaxStacks> stacks{};  // of ours
  std::size_t stack_count = 0;
};
AllocationRecord& allocation_record();  // of this thread

// Called by whatever watches the allocator, after each allocation of this thread.
void note_allocation(std::size_t bytes);

bool is_foreign(const Stack& stack);

}  // namespace visum::test_support
