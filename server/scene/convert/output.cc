#include "server/scene/convert/output.h"

#include <algorithm>
#include <charconv>
#include <fstream>

#include "protocol/config/config.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

std::string file_name_of(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const bool kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '-' || c == '.' || c == '_';
    plain += kept ? c : '_';
  }
  return plain.empty() || plain.front() == '.' ? "_" + plain : plain;
}

std::string obj_of(const world::TriangleMesh& mesh) {
  std::string text;
  for (const auto& vertex : mesh.vertices) text += "v " + exact(vertex.data(), 3) + "\n";
  for (const auto& [a, b, c] : mesh.triangles)
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  return text;
}

void write_file(const fs::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out << bytes;
  out.close();
  if (!out) throw config::ConfigError({file.string(), 0, ""}, "cannot be written");
}

}  // namespace

Output::Output(fs::path file) : file_(std::move(file)), folder_(file_) {
  folder_ += "_files";
}

void Output::lose(const std::string& sentence) {
  if (std::ranges::find(losses_, sentence) == losses_.end()) losses_.push_back(sentence);
}

std::string Output::path_to(const fs::path& other) const {
  const fs::path folder = fs::absolute(file_).parent_path();
  const fs::path relative =
      fs::absolute(other).lexically_normal().lexically_relative(folder.lexically_normal());
  return relative.empty() ? fs::absolute(other).string() : relative.string();
}

std::string Output::add_file(const std::string& name, std::string bytes) {
  std::string unique = file_name_of(name);
  const auto taken = [&](const std::string& wanted) {
    return std::ranges::any_of(companions_, [&](const Companion& known) { return known.name == wanted; });
  };
  for (int i = 2; taken(unique); ++i) unique = std::to_string(i) + "_" + file_name_of(name);
  companions_.push_back({unique, std::move(bytes), nullptr});
  return folder_.filename().string() + "/" + unique;
}

std::string Output::add_mesh(const world::TriangleMesh& mesh) {
  const auto known = std::ranges::find(companions_, static_cast<const void*>(&mesh), &Companion::source);
  if (known != companions_.end()) return folder_.filename().string() + "/" + known->name;
  const std::string path = add_file(fs::path(mesh.name).stem().string() + ".obj", obj_of(mesh));
  companions_.back().source = &mesh;
  return path;
}

void Output::write(const std::string& text) const {
  std::error_code error;
  if (!companions_.empty()) fs::create_directory(folder_, error);
  for (const Companion& companion : companions_) write_file(folder_ / companion.name, companion.bytes);
  write_file(file_, text);
}

std::string exact(double number) {
  char text[32];
  const auto [end, fault] = std::to_chars(text, text + sizeof text, number);
  return fault == std::errc() ? std::string(text, end) : std::string("nan");
}

std::string exact(const double* numbers, std::size_t count, const char* between) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : between) + exact(numbers[i]);
  return text;
}

}  // namespace visum::scene
