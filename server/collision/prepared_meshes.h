// Triangle meshes and hulls of a world, prepared for collision once and shared by all its stages: a world is
// searched for overlaps before it starts, and gets a new stage when bodies come or go.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

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
  // Those of the meshes whose tree or hull is not prepared yet, in their order; equal ones count once.
  std::vector<const world::TriangleMesh*> without_tree(const std::vector<const world::TriangleMesh*>& wanted);
  std::vector<const world::TriangleMesh*> without_hull(const std::vector<const world::TriangleMesh*>& wanted);
  std::size_t count();  // of what is prepared
  // Lets go of what nobody else has, such as the meshes of bodies that went.
  void forget_unused();

 private:
  template <typename Piece>
  struct Known {
    world::TriangleMesh source;
    std::shared_ptr<const Piece> piece;
  };
  template <typename Piece>
  using Pieces = std::unordered_multimap<std::uint64_t, Known<Piece>>;  // by a hash of the source

  template <typename Piece, typename Make>
  std::shared_ptr<const Piece> find_or_make(Pieces<Piece>& pieces, const world::TriangleMesh& mesh,
                                            Make make);
  template <typename Piece>
  std::vector<const world::TriangleMesh*> missing(const Pieces<Piece>& pieces,
                                                  const std::vector<const world::TriangleMesh*>& wanted);

  std::mutex mutex_;
  Pieces<Mesh> meshes_;
  Pieces<Solid> hulls_;
};

}  // namespace visum::collision
