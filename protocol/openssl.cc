#include "protocol/openssl.h"

#include <string>

#include "protocol/config/shared_library.h"

namespace visum::protocol {
namespace {

// libcrypto comes with it.
OpenSsl load_openssl() {
  const config::SharedLibrary library("libssl.so." + std::to_string(OPENSSL_SHLIB_VERSION), "TLS: OpenSSL",
                                      "libssl3");
  OpenSsl functions;
#define VISUM_OPENSSL_FIND(name) library.find(#name, functions.name);
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
