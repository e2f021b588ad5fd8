// Which part of a floor a body has been near, by the world's truth. The floor is a rectangle of cells; those
// that stand in something fixed do not count.
#pragma once

#include <array>
#include <vector>

#include "protocol/messages.h"

namespace visum::run {

struct FloorSpec {
  std::array<double, 2> from{}, to{};  // opposite corners in the world, m
  double within_m = 0.0;               // so near is covered
  double cell_m = 0.1;
  double height_m = 0.1;  // above z = 0, at which something stands in the way
};
inline constexpr std::size_t kMaxFloorCells = 250'000;

class Coverage {
 public:
  // `fixed` holds the shapes that stand, with the numbers of their bodies.
  struct Obstacle {
    std::size_t body;
    protocol::ShapeDescription shape;
  };
  Coverage() = default;
  Coverage(const FloorSpec& spec, std::vector<Obstacle> obstacles);

  // What an earlier one has found, of the same floor and body: it may name other obstacles, by other numbers.
  void go_on(Coverage&& earlier);
  // The body is here now. `poses` as in a WorldSample.
  void note(double x, double y, const std::vector<double>& poses);
  double share() const;  // of the free cells; NaN before the first note()

 private:
  void find_free_cells(const std::vector<double>& poses);

  FloorSpec spec_;
  std::vector<Obstacle> obstacles_;
  std::vector<std::array<double, 2>> open_;  // centres of free cells that are not covered yet
  std::size_t free_ = 0;
  bool known_ = false;
};

// Whether cells can be told to be free of such a shape: not of meshes and hulls.
bool is_plain(const protocol::ShapeDescription& shape);

}  // namespace visum::run
