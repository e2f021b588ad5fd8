// The build id of a program or a shared library: a number that its linker makes of its content (the note
// NT_GNU_BUILD_ID of ELF). Tools that change a file afterwards may keep it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace visum::scene {

// A program or shared library, as it was when it ran.
struct CodeFile {
  std::string build_id, path;
};

// As build ids are written.
std::string hexadecimal(std::string_view bytes);

// In hexadecimal digits. Empty if the file has none, is no ELF file of this machine's form, or cannot be
// read.
std::string build_id_of(const std::filesystem::path& file);

// The one in a segment of notes (PT_NOTE) of this alignment.
std::string build_id_in(std::string_view notes, std::size_t alignment);

}  // namespace visum::scene
