#include "protocol/openssl.h"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace visum::protocol {
namespace {

[[noreturn]] void fail_to_load() {
  const char* const reason = ::dlerror();
  throw std::runtime_error(std::string("TLS: OpenSSL cannot be loaded: ") +
                           (reason ? reason : "no reason given"));
}

template <typename Function>
void find_function(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  if (function == nullptr) fail_to_load();
}

// libcrypto comes with it.
OpenSsl load_openssl() {
  const std::string file = "libssl.so." + std::to_string(OPENSSL_SHLIB_VERSION);
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) fail_to_load();
  OpenSsl functions;
#define VISUM_OPENSSL_FIND(name) find_function(library, #name, functions.name);
  VISUM_OPENSSL_FUNCTIONS(VISUM_OPENSSL_FIND)
#undef VISUM_OPENSSL_FIND
  return functions;
}

}  // namespace

const OpenSsl& openssl() {
  static const OpenSsl functions = load_openssl();
  return functions;
}

}  // namespace visum::protocol
