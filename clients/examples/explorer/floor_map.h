// The explorer's map of the floor: cells with something, cells with nothing, cells that it has covered, and
// the distance from everywhere to floor that is still to be covered. The explorer owns it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clients/examples/explorer/cart.h"

namespace visum::explorer {

class FloorMap {
 public:
  explicit FloorMap(double near_m);

  // Adds a ray from (x, y): its path is free, and something is at its end if it met anything.
  void see(double x, double y, double direction, double distance_m, bool met);
  void cover(double x, double y);  // everything within `near_m`
  double covered_m2() const;

  // Searches the ways anew. Returns false if there is no floor left to drive to.
  bool find_ways();
  double way_from(double x,
                  double y) const;   // m to the nearest floor worth a visit; infinite: there is no way
  void give_up(double x, double y);  // gives up the floor that way_from() leads to from there

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
  Disc keep_off_;                      // cells around something that the cart's middle must keep off
  std::vector<std::int8_t> evidence_;  // above 0: something; below: nothing; 0: never seen
  std::vector<std::uint8_t> done_;     // 1: covered, 2: given up
  std::vector<std::uint8_t> blocked_;  // by find_ways(), like the next
  std::vector<std::uint16_t> steps_;   // to floor worth a visit; kNoWay: none
};

}  // namespace visum::explorer
