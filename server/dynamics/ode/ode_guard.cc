#include "server/dynamics/ode/ode_guard.h"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <string>

#include "server/dynamics/ode/ode_library.h"

namespace visum::dynamics::ode {
namespace {

thread_local std::uint64_t messages = 0;

[[noreturn]] void throw_error(int number, const char* format, va_list arguments) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  throw OdeError("ODE error " + std::to_string(number) + ": " + text.data());
}

void count_message(int, const char*, va_list) {
  ++messages;
}

void initialise_process() {
  load_ode();
  dInitODE2(0);
  dSetErrorHandler(throw_error);
  dSetDebugHandler(throw_error);
  dSetMessageHandler(count_message);
}

}  // namespace

void ensure_ode() {
  static std::once_flag process;
  std::call_once(process, initialise_process);
  thread_local const int allocated = dAllocateODEDataForThread(dAllocateMaskAll);
  if (allocated == 0) throw OdeError("ODE cannot allocate its data for this thread");
}

std::uint64_t ode_messages() {
  return messages;
}

}  // namespace visum::dynamics::ode
