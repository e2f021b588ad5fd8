// Takes from the present process everything that it does not need to read a mesh.
#pragma once

namespace visum::collada {

#ifdef VISUM_SANITIZED
inline constexpr bool kForbids = false;  // a sanitizer needs more memory and system calls than this leaves
#else
inline constexpr bool kForbids = true;
#endif

// Bounds memory and processor time, forbids a core file, and makes the process die with its parent. Of the
// kernel it leaves memory, reading and writing of files that are open already, the clock and the exit; any
// other call kills the process. If kForbids is false, memory and calls stay free. Throws std::runtime_error
// if the kernel refuses.
void confine();

}  // namespace visum::collada
