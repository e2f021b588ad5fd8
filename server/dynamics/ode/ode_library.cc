#include "server/dynamics/ode/ode_library.h"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace visum::dynamics::ode {
namespace {

[[noreturn]] void fail_to_load() {
  const char* const reason = ::dlerror();
  throw std::runtime_error(std::string("the engine ODE cannot be loaded: ") +
                           (reason ? reason : "no reason given"));
}

template <typename Function>
void find_function(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  if (function == nullptr) fail_to_load();
}

}  // namespace

#define VISUM_ODE_POINTER(name) decltype(&::name) name = nullptr;
VISUM_ODE_FUNCTIONS(VISUM_ODE_POINTER)
#undef VISUM_ODE_POINTER

void load_ode() {
  void* const library = ::dlopen(VISUM_ODE_LIBRARY, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) fail_to_load();
#define VISUM_ODE_FIND(name) find_function(library, #name, name);
  VISUM_ODE_FUNCTIONS(VISUM_ODE_FIND)
#undef VISUM_ODE_FIND
}

}  // namespace visum::dynamics::ode
