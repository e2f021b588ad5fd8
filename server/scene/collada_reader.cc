#include "server/scene/collada_reader.h"

#include <array>
#include <charconv>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "protocol/config/read_file.h"
#include "server/scene/mesh_readers.h"
#include "server/scene/reader_process.h"
#include "server/world/on_processors.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxParts = 1000;

constexpr std::string_view kCode = "code ";
constexpr std::size_t kReadAhead = std::size_t{64} << 20;  // bytes of files that wait for a reader

[[noreturn]] void fail_answer() {
  throw std::runtime_error("its reader's answer is not a mesh");
}

// Takes the next line off `text`.
std::string take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) fail_answer();
  const std::string line(text.substr(0, end));
  text.remove_prefix(end + 1);
  return line;
}

// Reads "R G B A BYTES" or "none BYTES" and returns BYTES.
std::size_t read_part_line(std::istringstream& words, ColladaPart& part) {
  std::string first;
  words >> first;
  if (first != "none") {
    auto& color = part.color.emplace();
    const auto [end, error] = std::from_chars(first.data(), first.data() + first.size(), color[0]);
    if (error != std::errc{} || end != first.data() + first.size()) fail_answer();
    words >> color[1] >> color[2] >> color[3];
    for (const double share : color)
      if (!(share >= 0.0 && share <= 1.0)) fail_answer();
  }
  std::size_t bytes = 0;
  if (!(words >> bytes) || !(words >> std::ws).eof()) fail_answer();
  return bytes;
}

// Takes the lines of the files that the reader ran with.
std::vector<CodeFile> take_code(std::string_view& answer) {
  std::vector<CodeFile> files;
  while (answer.starts_with(kCode)) {
    if (files.size() == AnswerCache::kMaxCode) fail_answer();
    const std::string line = take_line(answer).substr(kCode.size());
    const auto space = line.find(' ');
    if (space == std::string::npos) fail_answer();
    files.push_back({line.substr(0, space), line.substr(space + 1)});
  }
  return files;
}

fs::path program_beside_this() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path() / "visum-mesh";
}

ColladaMesh convert(const fs::path& file, const config::FileContent& content, const ColladaProcess& process) {
  if (!content.fault.empty()) throw std::runtime_error("it cannot be opened: " + content.fault);
  const std::string program = process.program.empty() ? program_beside_this().string() : process.program;
  const AnswerCache& cache = process.cache ? *process.cache : answer_cache();
  const auto question = cache.ask(program, content.bytes);
  if (const auto known = cache.find(question)) return read_collada_answer(*known, file.string());
  const std::string answer = run_reader(program, content.bytes, {process.deadline, kMaxMeshBytes});
  ColladaMesh mesh = read_collada_answer(answer, file.string());
  std::string_view left = answer;
  const auto code = take_code(left);
  cache.keep(question, left, code);
  return mesh;
}

}  // namespace

bool is_collada(const fs::path& file) {
  return lower_extension(file) == ".dae";
}

ColladaMesh read_collada_answer(std::string_view answer, const std::string& file) {
  ColladaMesh whole;
  take_code(answer);
  while (true) {
    std::istringstream words(take_line(answer));
    std::string word;
    words >> word;
    if (word == "end" && answer.empty() && !whole.parts.empty()) return whole;
    if (word == "textured") {
      whole.textured = true;
      continue;
    }
    if (word != "part") fail_answer();
    if (whole.parts.size() == kMaxParts)
      throw std::runtime_error("it has more than " + std::to_string(kMaxParts) + " materials");
    ColladaPart part;
    const std::size_t bytes = read_part_line(words, part);
    if (bytes > answer.size()) fail_answer();
    part.mesh = read_stl(answer.substr(0, bytes), file);
    part.mesh.name = fs::path(file).filename().string();
    answer.remove_prefix(bytes);
    whole.parts.push_back(std::move(part));
  }
}

ColladaMesh read_collada(const fs::path& file, const ColladaProcess& process) {
  return convert(file, config::read_file(file, kMaxMeshBytes), process);
}

std::vector<ColladaResult> read_all_collada(std::span<const fs::path> files, const ColladaProcess& process) {
  std::vector<ColladaResult> results(files.size());
  std::vector<config::FileContent> contents;
  for (std::size_t first = 0; first < files.size(); first += contents.size()) {
    contents.clear();
    // The files are read on this thread, which may note what it reads, or be given it.
    for (std::size_t bytes = 0; first + contents.size() < files.size() && bytes < kReadAhead;
         bytes += contents.back().bytes.size())
      contents.push_back(config::read_file(files[first + contents.size()], kMaxMeshBytes));
    world::on_processors(contents.size(), kMostReaders, [&](std::size_t i) {
      try {
        results[first + i].mesh = convert(files[first + i], contents[i], process);
      } catch (...) {
        results[first + i].fault = std::current_exception();
      }
    });
  }
  return results;
}

}  // namespace visum::scene
