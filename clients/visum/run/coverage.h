// The share of a floor that a body has been near, from the world's true positions. The floor is a rectangle
// of cells; cells inside something fixed do not count.
#pragma once

#include <array>
#include <vector>

#include "protocol/messages.h"

namespace visum::run {

struct FloorSpec {
  std::array<double, 2> from{}, to{};  // opposite corners in the world, m
  double within_m = 0.0;               // a cell nearer than this is covered
  double cell_m = 0.1;
  double height_m = 0.1;  // above z = 0; a fixed shape at this height blocks a cell
};
inline constexpr std::size_t kMaxFloorCells = 250'000;

class Coverage {
 public:
  // A fixed shape, with the number of its body.
  struct Obstacle {
    std::size_t body;
    protocol::ShapeDescription shape;
  };
  Coverage() = default;
  Coverage(const FloorSpec& spec, std::vector<Obstacle> obstacles);

  // Takes over the result of an earlier object of the same floor and body, whose bodies may have had other
  // numbers.
  void go_on(Coverage&& earlier);
  // Notes that the body is here now. `poses` is that of a WorldSample.
  void note(double x, double y, const std::vector<double>& poses);
  double share() const;  // covered cells by free cells, 0 to 1; NaN before the first note()

 private:
  void find_free_cells(const std::vector<double>& poses);

  FloorSpec spec_;
  std::vector<Obstacle> obstacles_;
  std::vector<std::array<double, 2>> open_;  // centres of free cells that are not covered yet
  std::size_t free_ = 0;
  bool known_ = false;
};

// True if a cell can be tested against such a shape, which is not so for meshes and hulls.
bool is_plain(const protocol::ShapeDescription& shape);

}  // namespace visum::run
