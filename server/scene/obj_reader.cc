// Reads the geometry of Wavefront OBJ: `v` and `f` (corners as 7, 7/1, 7//3, 7/1/3; negative numbers count
// from the end). Polygons become fans of triangles, which is right for convex ones. Everything about looks is
// skipped.
#include <algorithm>
#include <array>
#include <vector>

#include "server/scene/mesh_readers.h"
#include "server/scene/text_cursor.h"

namespace visum::scene {
namespace {

constexpr std::size_t kMaxCorners = 1000;  // of one polygon
constexpr std::array<std::string_view, 14> kSkipped = {
    "vn", "vt", "vp", "o", "g", "s", "l", "p", "usemtl", "mtllib", "mg", "lod", "bevel", "usemap"};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file) : text_(text), file_(file), builder_(file) {}

  world::TriangleMesh read() {
    while (!text_.empty()) {
      ++line_;
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      read_line(text_.substr(0, end));
      text_.remove_prefix(std::min(end + 1, text_.size()));
    }
    return builder_.take();
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw config::ConfigError({file_, line_, ""}, message);
  }

  void read_line(std::string_view line) {
    TextCursor cursor(line.substr(0, line.find('#')));
    const std::string_view keyword = cursor.word();
    if (keyword == "v")
      read_vertex(cursor);
    else if (keyword == "f")
      read_face(cursor);
    else if (!keyword.empty() && std::find(kSkipped.begin(), kSkipped.end(), keyword) == kSkipped.end())
      fail("'" + std::string(keyword.substr(0, 40)) + "' is not a keyword of an OBJ file");
  }

  void read_vertex(TextCursor& cursor) {
    Eigen::Vector3d point;
    for (int i = 0; i < 3; ++i) {
      if (!parse_number(cursor.word(), point[i])) fail("a vertex needs three numbers");
    }
    vertices_.push_back(point);
  }

  Eigen::Vector3d corner(std::string_view word) const {
    const std::string_view number = word.substr(0, word.find('/'));
    std::int64_t index = 0;
    if (!parse_number(number, index))
      fail("'" + std::string(word.substr(0, 40)) + "' is not a valid corner of a face");
    const auto count = static_cast<std::int64_t>(vertices_.size());
    const std::int64_t from_start = index < 0 ? count + index : index - 1;
    if (from_start < 0 || from_start >= count)
      fail("face names vertex " + std::to_string(index) + ", there are " + std::to_string(count) + " so far");
    return vertices_[static_cast<std::size_t>(from_start)];
  }

  void read_face(TextCursor& cursor) {
    std::vector<Eigen::Vector3d> corners;
    for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
      if (corners.size() == kMaxCorners)
        fail("a face has more than " + std::to_string(kMaxCorners) + " corners");
      corners.push_back(corner(word));
    }
    if (corners.size() < 3) fail("a face needs three corners, has " + std::to_string(corners.size()));
    for (std::size_t i = 2; i < corners.size(); ++i)
      builder_.add({corners[0], corners[i - 1], corners[i]}, line_);
  }

  std::string_view text_;
  const std::string& file_;
  MeshBuilder builder_;
  std::vector<Eigen::Vector3d> vertices_;
  int line_ = 0;
};

}  // namespace

world::TriangleMesh read_obj(std::string_view text, const std::string& file) {
  return ObjReader(text, file).read();
}

}  // namespace visum::scene
