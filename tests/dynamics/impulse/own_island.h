// An island of rows with its arrays, for tests of the solver.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {

struct OwnIsland {
  static constexpr double kGive = 1e-5;  // see rows.cc: for a contact's normal

  std::vector<RowBlock> blocks;
  std::vector<double> velocities;
  std::vector<FreeBody> bodies;
  std::vector<double> responses;

  void prepare(Rows& rows) {
    island = {blocks, velocities, bodies, responses};
    rows.prepare(island);
  }
  void solve(Rows& rows, int most_sweeps) { rows.solve(most_sweeps, 1e-11, 1e-7, 0.0); }
  bool is_solved() const { return island.solved; }
  bool is_inexact() const { return island.inexact; }
  void set_calm() { island.calm = true; }
  void set_dear(std::uint64_t units) {
    island.moves = true;
    island.dear = units;
  }
  double largest_change() const { return island.largest_change; }
  // Largest difference between the impulses and those that the velocities ask for, m/s.
  double miss() const {
    double largest = 0.0;
    for (const RowBlock& block : blocks) {
      const auto& lambda = block.lambda;
      const double K = std::max({block.K[0], block.K[1], block.K[2]});
      const double normal = lambda[0] - (velocity(block, 0) + kGive * block.K[0] * lambda[0]) / K;
      const double along = lambda[1] - velocity(block, 1) / K, across = lambda[2] - velocity(block, 2) / K;
      const double held = std::hypot(along, across), most = block.friction * lambda[0];
      const double share = held > most ? most / held : 1.0;
      for (const double change :
           {std::max(0.0, normal) - lambda[0], share * along - lambda[1], share * across - lambda[2]})
        largest = std::max(largest, K * std::abs(change));
    }
    return largest;
  }

 private:
  double velocity(const RowBlock& block, std::size_t row) const {
    double sum = 0.0;
    for (std::size_t e = 0; e < block.end_count; ++e) {
      const RowEnd& end = block.ends[e];
      if (!end.free)
        sum += velocities[end.offset + end.first + row];
      else
        for (std::size_t j = 0; j < 6; ++j) sum += end.J[row][j] * velocities[end.offset + j];
    }
    return sum;
  }

  RowIsland island;
};

}  // namespace visum::dynamics::impulse
