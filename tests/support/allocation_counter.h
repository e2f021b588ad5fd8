// Counts what a thread allocates in a scope, and whether our code or a library that works inside our tick
// allocated it.
//
// A program that links visum_test_support has its malloc family replaced by one that counts (under
// sanitizers, their hooks are used instead). So `new`, malloc, and everything that libraries do with them are
// seen. Only the thread that opened an AllocationScope is counted, and only while the scope is open. Scopes
// do not nest.
//
// The call stack decides who allocated. It is read from the inside out; the C and C++ run-time libraries and
// templates of std:: and Eigen:: are skipped, and the first frame that is left counts. A frame in ODE,
// libccd, Embree or TBB makes the allocation foreign, and so does a function of FCL, by its name. Any other
// frame, or a stack that cannot be read, makes it ours. So a callback of ours that allocates while FCL calls
// it is ours, and a std::vector that grows inside FCL is foreign.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace visum::test_support {

struct AllocationCounts {
  std::uint64_t ours = 0;
  std::uint64_t ours_bytes = 0;
  std::uint64_t foreign = 0;  // by ODE, libccd, Embree, TBB, FCL
  std::uint64_t foreign_bytes = 0;
};

class AllocationScope {
 public:
  AllocationScope();   // begins to count; aborts if this thread has a scope open
  ~AllocationScope();  // stops counting
  AllocationScope(const AllocationScope&) = delete;
  AllocationScope& operator=(const AllocationScope&) = delete;

  AllocationCounts counts() const;  // until now
  // The call stacks of our first allocations, for a test's message, with symbols that the program exports.
  // Does not count itself.
  std::string describe_ours() const;
};

}  // namespace visum::test_support
