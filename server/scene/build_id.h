// The build id of a program or a shared library: a number that its linker makes of its whole content (the
// note NT_GNU_BUILD_ID of ELF). Two files with one build id hold the same code.
#pragma once

#include <filesystem>
#include <string>

namespace visum::scene {

// In hexadecimal digits. Empty if the file has none, is no ELF file of this machine, or cannot be read.
std::string build_id_of(const std::filesystem::path& file);

}  // namespace visum::scene
