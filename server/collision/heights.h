// Finds the points that lie above a plane, or the planes that a point lies above, among many. Most of a
// hull's making is this question.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

namespace visum::collision {

// A list of points, or of planes. It answers roughly, in single precision and for many at once: it finds all
// that the caller looks for and few others, which the caller sorts out exactly. So no result depends on it.
class Heights {
 public:
  // For points and planes near these.
  explicit Heights(std::span<const Eigen::Vector3d> points) {
    Eigen::Vector3d low = points[0], high = points[0];
    for (const Eigen::Vector3d& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    middle_ = 0.5 * (low + high);
    size_ = std::max((high - low).norm(), std::numeric_limits<double>::min());
    rounding_ = kSingle + kDouble * middle_.norm() / size_;
  }

  void add_point(const Eigen::Vector3d& point) { add((point - middle_) / size_, 0.0); }
  // The plane of all x with normal · x = offset. The normal is a unit vector.
  void add_plane(const Eigen::Vector3d& normal, double offset) {
    add(normal, (normal.dot(middle_) - offset) / size_);
  }
  void drop(std::size_t i) { rows_[3][i] = kNowhere; }  // it is found no more
  void clear() {
    for (auto& row : rows_) row.clear();
    count_ = 0;
  }

  // Both call visit(index), in ascending order, for all whose height is more than `limit`, in m.
  template <typename Visit>
  void visit_points_above(const Eigen::Vector3d& normal, double offset, double limit, Visit visit) const {
    visit_above(normal, (normal.dot(middle_) - offset) / size_, limit / size_, visit);
  }
  template <typename Visit>
  void visit_planes_below(const Eigen::Vector3d& point, double limit, Visit visit) const {
    visit_above((point - middle_) / size_, 0.0, limit / size_, visit);
  }

 private:
  static constexpr std::size_t kBlock = 16;
  static constexpr float kNowhere = -std::numeric_limits<float>::infinity();
  static constexpr double kSingle = 2e-6;  // share of the size: thirty roundings
  static constexpr double kDouble = 1e-14;
  using Four = float __attribute__((vector_size(16)));
  using FourMask = std::int32_t __attribute__((vector_size(16)));

  void add(const Eigen::Vector3d& vector, double offset) {
    if (count_ % kBlock == 0)
      for (std::size_t i = 0; i < 4; ++i) rows_[i].resize(count_ + kBlock, i == 3 ? kNowhere : 0.0f);
    for (std::size_t i = 0; i < 3; ++i)
      rows_[i][count_] = static_cast<float>(vector[static_cast<Eigen::Index>(i)]);
    rows_[3][count_++] = static_cast<float>(offset);
  }

  template <typename Visit>
  void visit_above(const Eigen::Vector3d& vector, double offset, double limit, Visit visit) const {
    const auto x = static_cast<float>(vector.x()), y = static_cast<float>(vector.y()),
               z = static_cast<float>(vector.z());
    const auto least = static_cast<float>(limit - offset - rounding_);
    for (std::size_t first = 0; first < count_; first += kBlock) {
      std::array<Four, kBlock / 4> heights;
      FourMask higher{};
      for (std::size_t i = 0; i < heights.size(); ++i) {
        const auto row = [&](std::size_t k) {
          Four four;
          std::memcpy(&four, rows_[k].data() + first + 4 * i, sizeof four);
          return four;
        };
        heights[i] = x * row(0) + y * row(1) + z * row(2) + row(3);
        higher |= ~(heights[i] <= least);  // so that what is not a number is visited
      }
      const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(higher);
      if ((halves[0] | halves[1]) == 0) continue;
      for (std::size_t i = 0; i < kBlock; ++i)
        if (!(heights[i / 4][i % 4] <= least)) visit(first + i);
    }
  }

  Eigen::Vector3d middle_;
  double size_, rounding_;
  std::array<std::vector<float>, 4> rows_;  // x, y, z and an offset, filled up to a full block with nothing
  std::size_t count_ = 0;
};

}  // namespace visum::collision
