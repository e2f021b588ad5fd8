// Takes everything from the present process that reading a mesh does not need.
#pragma once

namespace visum::collada {

#ifdef VISUM_SANITIZED
inline constexpr bool kForbids = false;  // a sanitizer needs more memory and calls than are left
#else
inline constexpr bool kForbids = true;
#endif

// From now on: bounded memory and processor time, no core file, and of the kernel only memory, reading and
// writing what is open already, the clock and the exit; anything else kills the process. It dies with its
// parent. Memory and calls stay free where kForbids is false. Throws std::runtime_error where the kernel
// refuses.
void confine();

}  // namespace visum::collada
