// Numbers points: equal ones have one number, in the order in which they first came.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace visum::world {

// Equal points have one hash, of which all bits are spread. It differs from process to process; the numbers
// of points do not.
std::uint64_t hash_of(const Eigen::Vector3d& point);

// A plain value. Coordinates must not be NaN; -0 equals 0.
class PointNumbers {
 public:
  std::uint32_t number(const Eigen::Vector3d& point);

  // Empties it.
  std::vector<Eigen::Vector3d> take_points() {
    table_.clear();
    return std::exchange(points_, {});
  }

 private:
  std::size_t slot_of(const Eigen::Vector3d& point) const;
  void grow();

  std::vector<Eigen::Vector3d> points_;
  std::vector<std::uint32_t> table_;  // numbers + 1 by hash, with linear probing; 0: a free slot
};

}  // namespace visum::world
