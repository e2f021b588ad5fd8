// Collada meshes, for looks only: another process, visum-mesh, turns them into plain triangles, which our own
// reader takes. That process may fail, die or hang; then there is a reason, and no mesh.
#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/world_model.h"

namespace visum::scene {

struct ColladaPart {
  world::TriangleMesh mesh;  // m, in the document's axes
  std::optional<std::array<double, 4>> color;
};

struct ColladaMesh {
  std::vector<ColladaPart> parts;  // by material
  bool textured = false;           // has textures, which are not shown
};

// The process that reads, and how long it may take by the wall clock.
struct ColladaProcess {
  std::string program;  // empty: visum-mesh beside the running program
  std::chrono::milliseconds deadline{30'000};
};

// By the file's extension.
bool is_collada(const std::filesystem::path& file);

// Throws std::runtime_error: why there is no mesh, as what "it" (the file) is or its reader did.
ColladaMesh read_collada(const std::filesystem::path& file, const ColladaProcess& process = {});

// What visum-mesh answered (collada/import.h has the form); `file` only names the place in errors. Throws
// as above.
ColladaMesh read_collada_answer(std::string_view answer, const std::string& file);

}  // namespace visum::scene
