#include "server/sensing/embree.h"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace visum::sensing {
namespace {

[[noreturn]] void fail() {
  const char* const reason = ::dlerror();
  throw std::runtime_error(std::string("the ray tracer (Embree) cannot be loaded: ") +
                           (reason ? reason : "no reason given"));
}

template <typename Function>
void find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  if (function == nullptr) fail();
}

Embree load() {
  void* const library = ::dlopen(VISUM_EMBREE_LIBRARY, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) fail();
  Embree functions;
#define VISUM_EMBREE_FIND(name) find(library, "rtc" #name, functions.name);
  VISUM_EMBREE_FUNCTIONS(VISUM_EMBREE_FIND)
#undef VISUM_EMBREE_FIND
  return functions;
}

}  // namespace

const Embree& embree() {
  static const Embree functions = load();
  return functions;
}

}  // namespace visum::sensing
