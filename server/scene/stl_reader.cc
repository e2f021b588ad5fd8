// STL. Binary: 80 bytes of header, a count (u32), and for each triangle 12 floats (normal, corners) and a
// u16, all little-endian. Text: `solid NAME`, facets, `endsolid NAME`. A binary file may begin with the word
// "solid", too, so the size decides: a binary file has exactly 84 + 50 * count bytes.
#include <algorithm>
#include <bit>
#include <cstring>

#include "server/scene/mesh_readers.h"
#include "server/scene/text_cursor.h"

namespace visum::scene {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;
constexpr std::size_t kNormalBytes = 12;

std::uint32_t binary_count(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

std::uint64_t binary_size(std::uint32_t count) {
  return kHeaderBytes + std::uint64_t{kTriangleBytes} * count;
}

Eigen::Vector3d binary_vertex(const char* bytes) {
  float xyz[3];
  std::memcpy(xyz, bytes, sizeof xyz);
  return {xyz[0], xyz[1], xyz[2]};
}

world::TriangleMesh read_binary(std::string_view bytes, const std::string& file) {
  MeshBuilder builder(file);
  for (std::size_t at = kHeaderBytes; at < bytes.size(); at += kTriangleBytes) {
    const char* corners = bytes.data() + at + kNormalBytes;
    builder.add({binary_vertex(corners), binary_vertex(corners + 12), binary_vertex(corners + 24)}, 0);
  }
  return builder.take();
}

// Reads the text form. Several solids in one file become one mesh.
class TextStl {
 public:
  TextStl(std::string_view text, const std::string& file) : cursor_(text), file_(file), builder_(file) {}

  world::TriangleMesh read() {
    while (true) {
      const std::string_view word = cursor_.word();
      if (word.empty()) break;
      if (is(word, "solid") || is(word, "endsolid"))
        cursor_.skip_line();
      else if (is(word, "facet"))
        read_facet();
      else
        fail_expected("facet", word);
    }
    return builder_.take();
  }

 private:
  static bool is(std::string_view word, std::string_view keyword) {
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                      [](char a, char b) { return (a | 0x20) == b; });
  }

  [[noreturn]] void fail_expected(std::string_view wanted, std::string_view word) const {
    const std::string is =
        word.empty() ? "the file ends" : "there is '" + std::string(word.substr(0, 40)) + "'";
    throw config::ConfigError({file_, cursor_.line(), ""}, "expected '" + std::string(wanted) + "', " + is);
  }

  void expect(std::string_view keyword) {
    const std::string_view word = cursor_.word();
    if (!is(word, keyword)) fail_expected(keyword, word);
  }

  Eigen::Vector3d vector() {
    Eigen::Vector3d xyz;
    for (int i = 0; i < 3; ++i) {
      const std::string_view word = cursor_.word();
      if (!parse_number(word, xyz[i])) fail_expected("a number", word);
    }
    return xyz;
  }

  void read_facet() {
    expect("normal");
    vector();  // the normal, which users compute from the corners
    expect("outer");
    expect("loop");
    std::array<Eigen::Vector3d, 3> corners;
    for (auto& corner : corners) {
      expect("vertex");
      corner = vector();
    }
    builder_.add(corners, cursor_.line());
    expect("endloop");
    expect("endfacet");
  }

  TextCursor cursor_;
  const std::string& file_;
  MeshBuilder builder_;
};

[[noreturn]] void fail_size(std::string_view bytes, const std::string& file) {
  if (bytes.size() < kHeaderBytes)
    throw config::ConfigError({file, 0, ""},
                              "is too short for an STL file: " + std::to_string(bytes.size()) + " bytes");
  const std::uint32_t count = binary_count(bytes);
  throw config::ConfigError({file, 0, ""}, "its count of " + std::to_string(count) + " triangles needs " +
                                               std::to_string(binary_size(count)) + " bytes, the file has " +
                                               std::to_string(bytes.size()));
}

}  // namespace

world::TriangleMesh read_stl(std::string_view bytes, const std::string& file) {
  if (bytes.size() >= kHeaderBytes && bytes.size() == binary_size(binary_count(bytes)))
    return read_binary(bytes, file);
  const bool text = bytes.substr(0, 5) == "solid" && bytes.find('\0') == std::string_view::npos;
  if (!text) fail_size(bytes, file);
  return TextStl(bytes, file).read();
}

}  // namespace visum::scene
