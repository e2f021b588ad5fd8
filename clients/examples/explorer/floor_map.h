// What the explorer knows of the floor: where it has seen something, where nothing, where it has been, and
// how far it is from everywhere to floor that is still to be covered.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clients/examples/explorer/cart.h"

namespace visum::explorer {

class FloorMap {
 public:
  explicit FloorMap(double near_m);

  // A ray from (x, y): free on its way, and something at its end if it met anything.
  void see(double x, double y, double direction, double distance_m, bool met);
  void cover(double x, double y);  // all within `near_m`
  double covered_m2() const;

  // Looks for the ways anew; false: there is nothing left to go to.
  bool find_ways();
  double way_from(double x, double y) const;  // m to the nearest floor worth going to; infinite: no way
  void give_up(double x, double y);           // the floor that way_from() leads to from there

  void reset();
  void save(plugin::StateOut& to) const;
  void load(plugin::StateIn& from);

 private:
  static constexpr int kSide = 160;
  static constexpr double kCell_m = 0.1;

  static bool inside(int i, int j) { return i >= 0 && j >= 0 && i < kSide && j < kSide; }
  static std::size_t at(int i, int j) { return static_cast<std::size_t>(i * kSide + j); }
  static std::array<int, 2> cell(double x, double y);
  using Disc = std::vector<std::array<int, 2>>;
  static Disc disc(double radius_m);
  bool passable(int i, int j) const;
  int to_be_covered_near(int i, int j) const;

  Disc near_;                          // cells that a visit covers
  Disc keep_off_;                      // of what stands there, in the way of the cart's middle
  std::vector<std::int8_t> evidence_;  // above 0: something; below: nothing; 0: never seen
  std::vector<std::uint8_t> done_;     // 1: covered, 2: given up
  std::vector<std::uint8_t> blocked_;  // as of find_ways(), like the next
  std::vector<std::uint16_t> steps_;   // to floor worth going to; kNoWay: none
};

}  // namespace visum::explorer
