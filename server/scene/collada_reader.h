// Reads Collada meshes, for looks only. A process of its own, visum-mesh, turns them into plain triangles,
// and our own reader takes those. That process may fail, die or hang; then there is no mesh, and a reason.
#pragma once

#include <array>
#include <chrono>
#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/scene/answer_cache.h"
#include "server/world/world_model.h"

namespace visum::scene {

struct ColladaPart {
  world::TriangleMesh mesh;  // m, in the document's axes
  std::optional<std::array<double, 4>> color;
};

struct ColladaMesh {
  std::vector<ColladaPart> parts;  // one for each material
  bool textured = false;           // it has textures, which are not shown
};

// The reading process, its time limit by the wall clock, and where its answers are kept.
struct ColladaProcess {
  std::string program;  // empty: the visum-mesh beside the running program
  std::chrono::milliseconds deadline{30'000};
  const AnswerCache* cache = nullptr;  // null: answer_cache()
};

// Decides by the file's extension.
bool is_collada(const std::filesystem::path& file);

// Reads the mesh. Throws std::runtime_error with the reason, as a clause about the file: "it cannot be
// opened".
ColladaMesh read_collada(const std::filesystem::path& file, const ColladaProcess& process = {});

// Reads several files as read_collada() does, by as many processes at once as there are processors for this
// thread, up to kMostReaders.
struct ColladaResult {
  ColladaMesh mesh;
  std::exception_ptr fault;  // what read_collada() would have thrown; null: nothing
};
std::vector<ColladaResult> read_all_collada(std::span<const std::filesystem::path> files,
                                            const ColladaProcess& process = {});
inline constexpr std::size_t kMostReaders = 4;

// Reads the answer of visum-mesh, whose form collada/import.h describes. `file` names the place in errors.
// Throws as read_collada() does.
ColladaMesh read_collada_answer(std::string_view answer, const std::string& file);

}  // namespace visum::scene
