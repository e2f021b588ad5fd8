#include "tests/protocol/memory_probe.h"

#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <new>

namespace {

thread_local std::size_t now_bytes = 0, most_bytes = 0;

void* counted(std::size_t size) {
  void* memory = std::malloc(size);
  if (!memory) throw std::bad_alloc();
  now_bytes += malloc_usable_size(memory);
  most_bytes = std::max(most_bytes, now_bytes);
  return memory;
}

void uncounted(void* memory) noexcept {
  if (memory) now_bytes -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void operator delete(void* memory) noexcept {
  uncounted(memory);
}
void operator delete[](void* memory) noexcept {
  uncounted(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  uncounted(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  uncounted(memory);
}

namespace visum::testing {

std::size_t most_allocated_during(const std::function<void()>& call) {
  const std::size_t before = now_bytes;
  most_bytes = before;
  call();
  return most_bytes - before;
}

}  // namespace visum::testing
