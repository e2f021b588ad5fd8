// Triangle meshes and hulls of a world, prepared for collision once and shared by all its stages: a world is
// searched for overlaps before it starts, and gets a new stage when bodies come or go.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "server/collision/convex.h"
#include "server/collision/gjk.h"
#include "server/collision/mesh.h"
#include "server/world/world_model.h"

namespace visum::collision {

// A convex shape as both algorithms of the narrow phase see it.
struct Solid {
  explicit Solid(Convex shape) : convex(std::move(shape)), gjk(convex) {}
  Convex convex;
  GjkShape gjk;
};

// Any thread may use it, several at once. What it returns is constant, and lives as long as somebody has it.
class PreparedMeshes {
 public:
  std::shared_ptr<const Mesh> mesh(const world::TriangleMesh& mesh);
  // Throws std::runtime_error where the vertices span no volume.
  std::shared_ptr<const Solid> hull(const world::TriangleMesh& mesh);
  // Lets go of what nobody else has, such as the meshes of bodies that went.
  void forget_unused();

 private:
  using Key = std::array<std::uint64_t, 4>;  // two words of XXH3 of the vertices, two of the triangles
  static Key key_of(const world::TriangleMesh& mesh);

  std::mutex mutex_;
  std::map<Key, std::shared_ptr<const Mesh>> meshes_;
  std::map<Key, std::shared_ptr<const Solid>> hulls_;
};

}  // namespace visum::collision
