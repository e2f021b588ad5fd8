#include "server/scene/collada/code.h"

#include <link.h>

#include <filesystem>
#include <span>
#include <system_error>
#include <vector>

#include "server/scene/build_id.h"

namespace visum::collada {
namespace {

// A file of code in this process, as it is in memory. The kernel adds one without a folder, which is none.
int add_code(dl_phdr_info* object, std::size_t, void* to) {
  std::error_code unknown;
  scene::CodeFile code{"", object->dlpi_name};
  if (code.path.empty()) code.path = std::filesystem::read_symlink("/proc/self/exe", unknown).string();
  for (const ElfW(Phdr) & segment : std::span(object->dlpi_phdr, object->dlpi_phnum))
    if (segment.p_type == PT_NOTE && code.build_id.empty())
      code.build_id = scene::build_id_in(
          {reinterpret_cast<const char*>(object->dlpi_addr + segment.p_vaddr), segment.p_memsz},
          segment.p_align);
  if (unknown || code.path.find('/') != std::string::npos)
    static_cast<std::vector<scene::CodeFile>*>(to)->push_back(code);
  return 0;
}

}  // namespace

std::string code_lines() {
  std::vector<scene::CodeFile> files;
  ::dl_iterate_phdr(add_code, &files);
  std::string lines;
  for (const auto& [build_id, path] : files) {
    if (build_id.empty() || path.empty() || path.find('\n') != std::string::npos) return "";
    lines += "code " + build_id + " " + path + "\n";
  }
  return lines;
}

}  // namespace visum::collada
