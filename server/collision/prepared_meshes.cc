#include "server/collision/prepared_meshes.h"

#define XXH_INLINE_ALL
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
  const std::uint64_t count = mesh.vertices.size();
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  XXH3_128bits_update(&state, &count, sizeof count);
  XXH3_128bits_update(&state, mesh.vertices.data(), mesh.vertices.size() * sizeof mesh.vertices[0]);
  XXH3_128bits_update(&state, mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0]);
  const XXH128_hash_t hash = XXH3_128bits_digest(&state);
  return {hash.low64, hash.high64};
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
