// Loads shared libraries whose functions only some runs need. A run without them starts sooner, and works
// where the library is missing.
#pragma once

#include <string>

namespace visum::config {

// A library that stays loaded until the process ends, longer than this object. Any thread.
class SharedLibrary {
 public:
  // Loads `file`, such as "libode.so.8", from where the system has its libraries. Throws std::runtime_error:
  // "PURPOSE cannot be loaded: REASON; install PACKAGE", with the reason of the system.
  SharedLibrary(const std::string& file, std::string purpose, std::string package);

  // Sets the pointer to the function of this name. Throws likewise where the library has none.
  template <typename Function>
  void find(const char* name, Function& function) const {
    function = reinterpret_cast<Function>(address_of(name));
  }

 private:
  void* address_of(const char* name) const;
  [[noreturn]] void fail() const;

  std::string purpose_, package_;
  void* library_;
};

}  // namespace visum::config
