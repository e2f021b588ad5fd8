#include "protocol/config/shared_library.h"

#include <dlfcn.h>

#include <stdexcept>
#include <utility>

namespace visum::config {

SharedLibrary::SharedLibrary(const std::string& file, std::string purpose, std::string package)
    : purpose_(std::move(purpose)),
      package_(std::move(package)),
      library_(::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)) {
  if (library_ == nullptr) fail();
}

void* SharedLibrary::address_of(const char* name) const {
  void* const address = ::dlsym(library_, name);
  if (address == nullptr) fail();
  return address;
}

void SharedLibrary::fail() const {
  const char* const reason = ::dlerror();
  throw std::runtime_error(purpose_ + " cannot be loaded: " + (reason ? reason : "no reason given") +
                           "; install " + package_);
}

}  // namespace visum::config
