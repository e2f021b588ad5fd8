#include "tests/protocol/memory_probe.h"

#include <algorithm>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VISUM_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define VISUM_SANITIZED 1
#endif
#endif

namespace {

thread_local std::size_t now_bytes = 0, most_bytes = 0;

void note_taken(std::size_t bytes) {
  now_bytes += bytes;
  most_bytes = std::max(most_bytes, now_bytes);
}

void note_given_back(std::size_t bytes) {
  now_bytes -= bytes;
}

}  // namespace

#ifdef VISUM_SANITIZED
// Sanitizers replace operator new; they report each call.
#include <sanitizer/allocator_interface.h>

namespace {
void on_malloc(const volatile void*, std::size_t bytes) {
  note_taken(bytes);
}
void on_free(const volatile void* memory) {
  if (memory) note_given_back(__sanitizer_get_allocated_size(memory));
}
[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
}  // namespace

#else

#include <malloc.h>

#include <cstdlib>
#include <new>

namespace {

void* counted(std::size_t size) {
  void* memory = std::malloc(size);
  if (!memory) throw std::bad_alloc();
  note_taken(malloc_usable_size(memory));
  return memory;
}

void uncounted(void* memory) noexcept {
  if (memory) note_given_back(malloc_usable_size(memory));
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

#endif

namespace visum::testing {

std::size_t most_allocated_during(const std::function<void()>& call) {
  const std::size_t before = now_bytes;
  most_bytes = before;
  call();
  return most_bytes - before;
}

}  // namespace visum::testing
