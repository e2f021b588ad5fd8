// Reads Collada files through assimp: triangles by colour. Only for the program visum-mesh, which may die of
// a bad file. assimp has a record of overflows, so the daemon never reads a file with it in its own process.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace visum::collada {

struct Part {
  std::optional<std::array<float, 4>>
      color;  // red, green, blue, alpha: 0 to 1; nothing if the file gives none
  std::vector<std::array<float, 9>> triangles;  // three corners each, m, in the file's axes
};

struct Import {
  std::vector<Part> parts;  // one for each material; none is empty
  bool textured = false;    // some material has a texture, which is not read
};

// Reads the document's whole scene. Its own unit becomes m. Its up axis is ignored: like RViz, robots'
// visuals are drawn in the link's axes as the file gives them. Throws std::runtime_error with the reason in
// one line.
Import import_collada(std::string_view document);

// The answer of visum-mesh, after a line "code BUILD_ID PATH" for its own file and for each shared library
// that it runs with (code.h). For each part: a line "part R G B A BYTES" ("part none BYTES" without a
// colour) and so many bytes of binary STL. Then a line "textured" if it is, and a line "end".
std::string to_answer(const Import& import);

}  // namespace visum::collada
