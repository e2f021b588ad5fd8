#include "server/scene/build_id.h"

#include <elf.h>
#include <link.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

namespace visum::scene {
namespace {

constexpr std::size_t kMaxNotes = 1u << 16;  // bytes; a program has some hundred

// Returns fewer bytes where the file ends.
std::string read_at(std::ifstream& file, std::uint64_t offset, std::size_t bytes) {
  std::string read(bytes, '\0');
  file.clear();
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(read.data(), static_cast<std::streamsize>(bytes));
  read.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return read;
}

template <typename T>
bool take(std::string_view& bytes, T& value) {
  if (bytes.size() < sizeof value) return false;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return true;
}

std::string hexadecimal(std::string_view bytes) {
  std::string digits;
  for (const char c : bytes)
    for (const int shift : {4, 0})
      digits += "0123456789abcdef"[(static_cast<unsigned char>(c) >> shift) & 15];
  return digits;
}

// Each note is a header, a name and a description; both end on a multiple of `alignment` bytes.
std::string id_among(std::string_view notes, std::size_t alignment) {
  const auto padded = [&](std::size_t size) { return (size + alignment - 1) / alignment * alignment; };
  ElfW(Nhdr) note{};
  while (take(notes, note)) {
    const std::size_t name = padded(note.n_namesz), whole = name + padded(note.n_descsz);
    if (whole > notes.size()) break;
    if (note.n_type == NT_GNU_BUILD_ID && notes.starts_with(std::string_view("GNU\0", 4)))
      return hexadecimal(notes.substr(name, note.n_descsz));
    notes.remove_prefix(whole);
  }
  return "";
}

}  // namespace

std::string build_id_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string begin = read_at(file, 0, sizeof(ElfW(Ehdr)));
  std::string_view left = begin;
  ElfW(Ehdr) header{};
  constexpr unsigned char kWordClass = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
  if (!take(left, header) || !begin.starts_with(ELFMAG) || header.e_ident[EI_CLASS] != kWordClass ||
      header.e_phentsize != sizeof(ElfW(Phdr)))
    return "";
  const std::string table = read_at(file, header.e_phoff, header.e_phnum * sizeof(ElfW(Phdr)));
  left = table;
  for (ElfW(Phdr) segment{}; take(left, segment);) {
    if (segment.p_type != PT_NOTE || segment.p_filesz > kMaxNotes) continue;
    const std::string notes = read_at(file, segment.p_offset, segment.p_filesz);
    if (const auto id = id_among(notes, segment.p_align == 8 ? 8 : 4); !id.empty()) return id;
  }
  return "";
}

}  // namespace visum::scene
