// Calls note_allocation() from the program's malloc. The program's symbols come before the C library's, so
// these definitions serve the shared libraries, too. operator new calls malloc.
#include <cerrno>
#include <cstddef>

#include "tests/support/allocation_record.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VISUM_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define VISUM_SANITIZED 1
#endif
#endif

#ifdef VISUM_SANITIZED
// Sanitizers replace malloc; they report each call.
#include <sanitizer/allocator_interface.h>

namespace {
void on_malloc(const volatile void*, std::size_t bytes) {
  visum::test_support::note_allocation(bytes);
}
void on_free(const volatile void*) {}
[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
}  // namespace

#else

extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* old, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);

void* malloc(std::size_t bytes) {
  visum::test_support::note_allocation(bytes);
  return __libc_malloc(bytes);
}

void* calloc(std::size_t count, std::size_t bytes) {
  visum::test_support::note_allocation(count * bytes);
  return __libc_calloc(count, bytes);
}

void* realloc(void* old, std::size_t bytes) {
  visum::test_support::note_allocation(bytes);
  return __libc_realloc(old, bytes);
}

void* memalign(std::size_t alignment, std::size_t bytes) {
  visum::test_support::note_allocation(bytes);
  return __libc_memalign(alignment, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  visum::test_support::note_allocation(bytes);
  return __libc_memalign(alignment, bytes);
}

int posix_memalign(void** result, std::size_t alignment, std::size_t bytes) {
  if (alignment < sizeof(void*) || (alignment & (alignment - 1)) != 0) return EINVAL;
  visum::test_support::note_allocation(bytes);
  *result = __libc_memalign(alignment, bytes);
  return *result || bytes == 0 ? 0 : ENOMEM;
}
}

#endif
