// The code that runs in this process: its program, and the shared libraries.
#pragma once

#include <string>

namespace visum::collada {

// A line "code BUILD_ID PATH" for each file of code: whoever keeps an answer has to know whose it is. Empty
// where one of them cannot be told. Before confine(), as it asks the kernel for the program's path.
std::string code_lines();

}  // namespace visum::collada
