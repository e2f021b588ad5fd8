#include "server/collision/prepared_meshes.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "server/collision/hull.h"

namespace visum::collision {
namespace {

std::uint64_t hash_of(const world::TriangleMesh& mesh) {
  return XXH3_64bits(mesh.vertices.data(), mesh.vertices.size() * sizeof mesh.vertices[0]);
}

// Compares bits: where one has -0 and the other 0, a tree may have other signs.
bool is_same(const world::TriangleMesh& a, const world::TriangleMesh& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0);
  };
  return equal(a.vertices, b.vertices) && equal(a.triangles, b.triangles);
}

}  // namespace

// Pieces are made without the lock, as that takes long. Where two threads make the same, the first one's
// stays.
template <typename Piece, typename Make>
std::shared_ptr<const Piece> PreparedMeshes::find_or_make(Pieces<Piece>& pieces,
                                                          const world::TriangleMesh& mesh, Make make) {
  const std::uint64_t hash = hash_of(mesh);
  const auto find = [&]() -> std::shared_ptr<const Piece> {
    const auto [begin, end] = pieces.equal_range(hash);
    for (auto known = begin; known != end; ++known)
      if (is_same(known->second.source, mesh)) return known->second.piece;
    return nullptr;
  };
  {
    const std::lock_guard lock(mutex_);
    if (auto known = find()) return known;
  }
  Known<Piece> made{mesh, make()};
  const std::lock_guard lock(mutex_);
  if (auto known = find()) return known;
  return pieces.emplace(hash, std::move(made))->second.piece;
}

std::shared_ptr<const Mesh> PreparedMeshes::mesh(const world::TriangleMesh& mesh) {
  return find_or_make(meshes_, mesh, [&] { return std::make_shared<const Mesh>(mesh); });
}

std::shared_ptr<const Solid> PreparedMeshes::hull(const world::TriangleMesh& mesh) {
  return find_or_make(hulls_, mesh,
                      [&] { return std::make_shared<const Solid>(make_convex(make_hull(mesh.vertices))); });
}

template <typename Piece>
std::vector<const world::TriangleMesh*> PreparedMeshes::missing(
    const Pieces<Piece>& pieces, const std::vector<const world::TriangleMesh*>& wanted) {
  std::unordered_multimap<std::uint64_t, const world::TriangleMesh*> found;  // by hash
  std::vector<const world::TriangleMesh*> result;
  for (const world::TriangleMesh* mesh : wanted) {
    const std::uint64_t hash = hash_of(*mesh);
    const auto [first, last] = found.equal_range(hash);
    if (std::any_of(first, last, [&](const auto& entry) { return is_same(*entry.second, *mesh); })) continue;
    found.emplace(hash, mesh);
    const std::lock_guard lock(mutex_);
    const auto [begin, end] = pieces.equal_range(hash);
    if (std::none_of(begin, end, [&](const auto& known) { return is_same(known.second.source, *mesh); }))
      result.push_back(mesh);
  }
  return result;
}

std::vector<const world::TriangleMesh*> PreparedMeshes::without_tree(
    const std::vector<const world::TriangleMesh*>& wanted) {
  return missing(meshes_, wanted);
}

std::vector<const world::TriangleMesh*> PreparedMeshes::without_hull(
    const std::vector<const world::TriangleMesh*>& wanted) {
  return missing(hulls_, wanted);
}

std::size_t PreparedMeshes::count() {
  const std::lock_guard lock(mutex_);
  return meshes_.size() + hulls_.size();
}

void PreparedMeshes::forget_unused() {
  const std::lock_guard lock(mutex_);
  const auto unused = [](const auto& known) { return known.second.piece.use_count() == 1; };
  std::erase_if(meshes_, unused);
  std::erase_if(hulls_, unused);
}

}  // namespace visum::collision
