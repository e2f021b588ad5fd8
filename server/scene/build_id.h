// The build id of a program or a shared library: a number that its linker makes of its content (the note
// NT_GNU_BUILD_ID of ELF). Files that linkers made differ where their build ids do, and are equal otherwise.
#pragma once

#include <filesystem>
#include <string>

namespace visum::scene {

// In hexadecimal digits. Empty if the file has none, is no ELF file of this machine, or cannot be read.
std::string build_id_of(const std::filesystem::path& file);

}  // namespace visum::scene
