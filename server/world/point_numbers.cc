#include "server/world/point_numbers.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <sys/auxv.h>

#include <array>
#include <cstring>

namespace visum::world {
namespace {

constexpr std::size_t kLeastSlots = 64;  // a power of two, as all sizes of the table
}  // namespace

// The seed differs from process to process: no file can be made whose points all meet in one slot.
std::uint64_t hash_of(const Eigen::Vector3d& point) {
  static const std::uint64_t seed = [] {
    std::uint64_t random = 0;
    if (const unsigned long given = ::getauxval(AT_RANDOM))
      std::memcpy(&random, reinterpret_cast<const void*>(given), sizeof random);
    return random;
  }();
  const std::array<double, 3> bits{point.x() + 0.0, point.y() + 0.0, point.z() + 0.0};  // -0 becomes 0
  return XXH3_64bits_withSeed(bits.data(), sizeof bits, seed);
}

// The slot that holds the point, or a free one.
std::size_t PointNumbers::slot_of(const Eigen::Vector3d& point) const {
  const std::size_t last = table_.size() - 1;
  std::size_t slot = hash_of(point) & last;
  while (table_[slot] != 0 && points_[table_[slot] - 1] != point) slot = (slot + 1) & last;
  return slot;
}

void PointNumbers::grow() {
  table_.assign(points_.empty() ? kLeastSlots : 2 * table_.size(), 0);
  for (std::uint32_t i = 0; i < points_.size(); ++i) table_[slot_of(points_[i])] = i + 1;
}

std::uint32_t PointNumbers::number(const Eigen::Vector3d& point) {
  if (2 * points_.size() >= table_.size()) grow();
  std::uint32_t& known = table_[slot_of(point)];
  if (known == 0) {
    points_.push_back(point);
    known = static_cast<std::uint32_t>(points_.size());
  }
  return known - 1;
}

}  // namespace visum::world
