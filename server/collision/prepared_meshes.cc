#include "server/collision/prepared_meshes.h"

#include <xxhash.h>

#include "server/collision/hull.h"

namespace visum::collision {
namespace {

template <typename Map, typename Make>
typename Map::mapped_type find_or_make(Map& known, const typename Map::key_type& key, Make make) {
  if (const auto found = known.find(key); found != known.end()) return found->second;
  return known.emplace(key, make()).first->second;
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
  const Key key = key_of(mesh);
  const std::lock_guard lock(mutex_);
  return find_or_make(meshes_, key, [&] { return std::make_shared<const Mesh>(mesh); });
}

std::shared_ptr<const Solid> PreparedMeshes::hull(const world::TriangleMesh& mesh) {
  const Key key = key_of(mesh);
  const std::lock_guard lock(mutex_);
  return find_or_make(hulls_, key,
                      [&] { return std::make_shared<const Solid>(make_convex(make_hull(mesh.vertices))); });
}

void PreparedMeshes::forget_unused() {
  const std::lock_guard lock(mutex_);
  const auto unused = [](const auto& known) { return known.second.use_count() == 1; };
  std::erase_if(meshes_, unused);
  std::erase_if(hulls_, unused);
}

}  // namespace visum::collision
