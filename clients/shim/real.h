// Finds the C library's function behind one that the shim replaces.
#pragma once

#include <dlfcn.h>

// NOLINTNEXTLINE: a template cannot name a function by its token.
#define VISUM_REAL(name)                                                \
  ([] {                                                                 \
    static decltype(&::name) const function =                           \
        reinterpret_cast<decltype(&::name)>(::dlsym(RTLD_NEXT, #name)); \
    return function;                                                    \
  }())
// glibc keeps an older condition variable under the same names, which dlsym() finds first on x86-64.
#define VISUM_REAL_CONDITION(name)                                                      \
  ([] {                                                                                 \
    static void* newer = ::dlvsym(RTLD_NEXT, #name, "GLIBC_2.3.2");                     \
    static decltype(&::name) const function =                                           \
        reinterpret_cast<decltype(&::name)>(newer ? newer : ::dlsym(RTLD_NEXT, #name)); \
    return function;                                                                    \
  }())

#define VISUM_EXPORT extern "C" __attribute__((visibility("default")))
