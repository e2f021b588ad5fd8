#include "server/scene/build_id.h"

#include <elf.h>
#include <link.h>

#include <bit>
#include <cstring>
#include <optional>
#include <string_view>

#include "server/scene/plain_file.h"

namespace visum::scene {
namespace {

constexpr std::size_t kMaxNotes = 1u << 16;  // bytes of a segment; programs have some hundred
constexpr std::size_t kMaxSegments = 128;    // programs have some ten
constexpr unsigned char kWordClass = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
constexpr unsigned char kByteOrder = std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;
constexpr std::string_view kOwner("GNU\0", 4);

template <typename T>
std::optional<T> value_at(std::string_view bytes, std::size_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T)) return std::nullopt;
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

std::string hexadecimal(std::string_view bytes) {
  std::string digits;
  for (const char c : bytes)
    for (const int shift : {4, 0})
      digits += "0123456789abcdef"[(static_cast<unsigned char>(c) >> shift) & 15];
  return digits;
}

// Each note is a header, its owner's name, and a description that begins at an aligned offset, as does the
// next note.
std::string build_id_in(std::string_view notes, std::size_t segment_alignment) {
  const std::size_t alignment = segment_alignment == 8 ? 8 : 4;
  const auto aligned = [&](std::size_t offset) { return (offset + alignment - 1) / alignment * alignment; };
  for (std::size_t at = 0;;) {
    const auto note = value_at<ElfW(Nhdr)>(notes, at);
    if (!note) return "";
    const std::string_view rest = notes.substr(at);
    const std::size_t description = aligned(sizeof *note + note->n_namesz);
    const std::size_t end = description + note->n_descsz;
    if (end > rest.size()) return "";
    if (note->n_type == NT_GNU_BUILD_ID && note->n_namesz == kOwner.size() &&
        rest.substr(sizeof *note).starts_with(kOwner))
      return hexadecimal(rest.substr(description, note->n_descsz));
    at += aligned(end);
    if (at > notes.size()) return "";
  }
}

std::string build_id_of(const std::filesystem::path& path) {
  const PlainFile file(path);
  if (!file.is_open()) return "";
  const std::string begin = file.read_at(0, sizeof(ElfW(Ehdr)));
  const auto header = value_at<ElfW(Ehdr)>(begin, 0);
  if (!header || !begin.starts_with(ELFMAG) || header->e_ident[EI_CLASS] != kWordClass ||
      header->e_ident[EI_DATA] != kByteOrder || header->e_phentsize != sizeof(ElfW(Phdr)) ||
      header->e_phnum > kMaxSegments)
    return "";
  const std::string table = file.read_at(header->e_phoff, header->e_phnum * sizeof(ElfW(Phdr)));
  for (std::size_t i = 0; i < header->e_phnum; ++i) {
    const auto segment = value_at<ElfW(Phdr)>(table, i * sizeof(ElfW(Phdr)));
    if (!segment || segment->p_type != PT_NOTE || segment->p_filesz > kMaxNotes) continue;
    const std::string notes = file.read_at(segment->p_offset, segment->p_filesz);
    if (const auto id = build_id_in(notes, segment->p_align); !id.empty()) return id;
  }
  return "";
}

}  // namespace visum::scene
