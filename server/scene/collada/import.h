// Collada files through assimp: triangles by colour. For the program visum-mesh alone, which may die of a bad
// file: assimp has a record of overflows, and no file of a stranger is read by it inside the daemon.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace visum::collada {

struct Part {
  std::optional<std::array<float, 4>> color;    // red, green, blue, alpha: 0 to 1; none: the file gives none
  std::vector<std::array<float, 9>> triangles;  // three corners each, m, in the axes of the file
};

struct Import {
  std::vector<Part> parts;  // one per material, none is empty
  bool textured = false;    // some material has a texture, which is not read
};

// All of the document's scene, in the file's own unit made m. Its up axis turns nothing: robots' visuals are
// drawn in the link's axes as they stand in the file, as RViz does. Throws std::runtime_error with the reason
// in one line.
Import import_collada(std::string_view document);

// What visum-mesh answers: for each part a line "part R G B A BYTES" ("part none BYTES" without a colour) and
// so many bytes of binary STL; "textured" on a line of its own where it is; "end".
std::string to_answer(const Import& import);

}  // namespace visum::collada
