#include "server/collision/prepared_meshes.h"

#include <xxhash.h>

#include "server/collision/hull.h"

namespace visum::collision {
namespace {

// Pieces are made without the lock, as that takes long. Where two threads make the same, the first one's
// stays.
template <typename Map, typename Make>
typename Map::mapped_type find_or_make(std::mutex& mutex, Map& known, const typename Map::key_type& key,
                                       Make make) {
  {
    const std::lock_guard lock(mutex);
    if (const auto found = known.find(key); found != known.end()) return found->second;
  }
  auto made = make();
  const std::lock_guard lock(mutex);
  return known.emplace(key, std::move(made)).first->second;
}

}  // namespace

PreparedMeshes::Key PreparedMeshes::key_of(const world::TriangleMesh& mesh) {
  const auto hash_of = [](const auto& list) {
    return XXH3_128bits(list.data(), list.size() * sizeof list[0]);
  };
  const XXH128_hash_t vertices = hash_of(mesh.vertices), triangles = hash_of(mesh.triangles);
  return {vertices.low64, vertices.high64, triangles.low64, triangles.high64};
}

std::shared_ptr<const Mesh> PreparedMeshes::mesh(const world::TriangleMesh& mesh) {
  return find_or_make(mutex_, meshes_, key_of(mesh), [&] { return std::make_shared<const Mesh>(mesh); });
}

std::shared_ptr<const Solid> PreparedMeshes::hull(const world::TriangleMesh& mesh) {
  return find_or_make(mutex_, hulls_, key_of(mesh),
                      [&] { return std::make_shared<const Solid>(make_convex(make_hull(mesh.vertices))); });
}

void PreparedMeshes::forget_unused() {
  const std::lock_guard lock(mutex_);
  const auto unused = [](const auto& known) { return known.second.use_count() == 1; };
  std::erase_if(meshes_, unused);
  std::erase_if(hulls_, unused);
}

}  // namespace visum::collision
