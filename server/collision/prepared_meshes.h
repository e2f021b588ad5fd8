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

// The hull of a mesh's vertices, as both algorithms of the narrow phase see it.
struct PreparedHull {
  explicit PreparedHull(Convex solid) : convex(std::move(solid)), gjk(std::make_shared<GjkShape>(convex)) {}
  Convex convex;
  std::shared_ptr<const GjkShape> gjk;
};

// Any thread may use it, several at once. What it returns is constant, and lives as long as somebody has it.
class PreparedMeshes {
 public:
  std::shared_ptr<const Mesh> mesh(const world::TriangleMesh& mesh);
  // Throws std::runtime_error where the vertices span no volume.
  std::shared_ptr<const PreparedHull> hull(const world::TriangleMesh& mesh);
  // Lets go of what nobody else has.
  void forget_unused();

 private:
  using Key = std::array<std::uint64_t, 2>;  // XXH3 of vertices and triangles
  static Key key_of(const world::TriangleMesh& mesh);

  std::mutex mutex_;
  std::map<Key, std::shared_ptr<const Mesh>> meshes_;
  std::map<Key, std::shared_ptr<const PreparedHull>> hulls_;
};

}  // namespace visum::collision
