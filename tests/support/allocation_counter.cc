#include "tests/support/allocation_counter.h"

#include <cxxabi.h>
#include <dlfcn.h>
#include <execinfo.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "tests/support/allocation_record.h"

namespace visum::test_support {
namespace {

constexpr std::string_view kForeignLibraries[] = {"libfcl.", "libccd.",     "liboctomap.", "liboctomath.",
                                                  "libode.", "libembree3.", "libtbb."};
constexpr std::string_view kRuntimeLibraries[] = {"libc.",    "libstdc++.", "libgcc_s.", "libm.",
                                                  "ld-linux", "libasan.",   "libtsan.",  "libubsan."};
// Mangled names of functions in std::, __gnu_cxx:: and Eigen::. Their caller counts instead.
constexpr std::string_view kPassedOver[] = {"_ZNSt",         "_ZNKSt",    "_ZSt",
                                            "_ZN9__gnu_cxx", "_ZN5Eigen", "_ZNK5Eigen"};
// The entries to the allocator: operator new, the malloc family, and the sanitizers' names for them.
constexpr std::string_view kAllocatorNames[] = {
    "_Zn", "malloc", "calloc", "realloc", "memalign", "aligned_alloc", "posix_memalign", "__interceptor_"};
constexpr std::string_view kForeignNames[] = {"_ZN3fcl", "_ZNK3fcl"};

template <std::size_t N>
bool any_begins(const std::string_view (&prefixes)[N], std::string_view text) {
  for (const auto prefix : prefixes)
    if (text.starts_with(prefix)) return true;
  return false;
}

enum class Owner { kUnknown, kOurs, kForeign };

// A return address points behind its call and maybe behind its function. One byte before it is inside.
bool look_up(void* return_address, Dl_info& info) {
  return dladdr(static_cast<char*>(return_address) - 1, &info) != 0 && info.dli_fname;
}

std::string_view symbol_of(const Dl_info& info) {
  return info.dli_sname ? info.dli_sname : "";
}

Owner owner_of_frame(void* address) {
  Dl_info info;
  if (!look_up(address, info)) return Owner::kOurs;
  const std::string_view path = info.dli_fname;
  const std::string_view library = path.substr(path.rfind('/') + 1);
  if (any_begins(kForeignLibraries, library)) return Owner::kForeign;
  if (any_begins(kRuntimeLibraries, library)) return Owner::kUnknown;
  if (any_begins(kForeignNames, symbol_of(info))) return Owner::kForeign;
  return any_begins(kPassedOver, symbol_of(info)) ? Owner::kUnknown : Owner::kOurs;
}

// The first frame outside of the allocator and this counter. It is the frame behind the outermost entry to
// the allocator; all entries stand near the inner end of the stack.
int first_caller(const Stack& stack) {
  constexpr int kNear = 12;
  int first = 0;
  for (int i = 0; i < std::min(stack.count, kNear); ++i) {
    Dl_info info;
    if (look_up(stack.frames[static_cast<std::size_t>(i)], info) &&
        any_begins(kAllocatorNames, symbol_of(info)))
      first = i + 1;
  }
  return first;
}

std::string name_of_frame(void* address) {
  Dl_info info;
  if (!look_up(address, info)) return "?";
  const std::unique_ptr<char, void (*)(void*)> name(
      info.dli_sname ? abi::__cxa_demangle(info.dli_sname, nullptr, nullptr, nullptr) : nullptr, std::free);
  if (name) return name.get();
  if (info.dli_sname) return info.dli_sname;
  char offset[32];
  std::snprintf(offset, sizeof offset, "+0x%zx",
                static_cast<std::size_t>(static_cast<char*>(address) - static_cast<char*>(info.dli_fbase)));
  return std::string(info.dli_fname) + offset;  // for addr2line
}

}  // namespace

AllocationRecord& allocation_record() {
  static constinit thread_local AllocationRecord record;
  return record;
}

bool is_foreign(const Stack& stack) {
  for (int i = first_caller(stack); i < stack.count; ++i)
    if (const Owner owner = owner_of_frame(stack.frames[static_cast<std::size_t>(i)]);
        owner != Owner::kUnknown)
      return owner == Owner::kForeign;
  return false;
}

void note_allocation(std::size_t bytes) {
  AllocationRecord& record = allocation_record();
  if (!record.counting || record.busy) return;
  record.busy = true;
  Stack stack;
  stack.count = backtrace(stack.frames.data(), kMaxFrames);
  const bool foreign = is_foreign(stack);
  (foreign ? record.counts.foreign : record.counts.ours) += 1;
  (foreign ? record.counts.foreign_bytes : record.counts.ours_bytes) += bytes;
  if (!foreign && record.stack_count < kMaxStacks) record.stacks[record.stack_count++] = stack;
  record.busy = false;
}

AllocationScope::AllocationScope() {
  AllocationRecord& record = allocation_record();
  if (record.counting) {
    std::fputs("AllocationScope: this thread has one open already\n", stderr);
    std::abort();
  }
  // The first call of backtrace() loads libgcc and allocates.
  Stack warm_up;
  backtrace(warm_up.frames.data(), kMaxFrames);
  record = AllocationRecord{};
  record.counting = true;
}

AllocationScope::~AllocationScope() {
  allocation_record().counting = false;
}

AllocationCounts AllocationScope::counts() const {
  return allocation_record().counts;
}

std::string AllocationScope::describe_ours() const {
  AllocationRecord& record = allocation_record();
  record.busy = true;
  std::string text;
  for (std::size_t i = 0; i < record.stack_count; ++i) {
    const Stack& stack = record.stacks[i];
    text += "allocation " + std::to_string(i + 1) + " of ours:\n";
    for (int frame = first_caller(stack); frame < stack.count; ++frame)
      text += "  " + name_of_frame(stack.frames[static_cast<std::size_t>(frame)]) + "\n";
  }
  record.busy = false;
  return text;
}

}  // namespace visum::test_support
