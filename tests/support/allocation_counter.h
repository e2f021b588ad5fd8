// Counts what a thread allocates in a scope, and who allocated: ours, or a library that works inside our
// tick.
//
// A program that links visum_test_support has its malloc family replaced by one that counts (under
// sanitizers: watched through their hooks), so that `new`, malloc and what libraries do with either are all
// seen. Only the thread that opened an AllocationScope is counted, and only while the scope is open. Scopes
// do not nest.
//
// Whose an allocation is follows from the call stack, read from the inside out: the C and C++ run-time
// libraries and templates of std:: and Eigen:: are skipped, the first frame that is left decides. A frame in
// FCL, libccd, octomap or ODE makes it theirs; any other frame, and a stack that cannot be read, makes it
// ours. So a callback of ours that allocates while FCL calls it is ours, and a std::vector that grows inside
// FCL is FCL's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace visum::test_support {

struct AllocationCounts {
  std::uint64_t ours = 0;
  std::uint64_t ours_bytes = 0;
  std::uint64_t foreign = 0;  // by FCL, libccd, octomap, ODE
  std::uint64_t foreign_bytes = 0;
};

class AllocationScope {
 public:
  AllocationScope();   // begins to count; aborts where this thread has a scope open
  ~AllocationScope();  // ends
  AllocationScope(const AllocationScope&) = delete;
  AllocationScope& operator=(const AllocationScope&) = delete;

  AllocationCounts counts() const;  // so far
  // The call stacks of the first of our allocations, with symbols where the program exports them; for a
  // test's message. Does itself not count.
  std::string describe_ours() const;
};

}  // namespace visum::test_support
