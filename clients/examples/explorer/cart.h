// The cart of models/cart as one speed and one curvature, and its odometry. A place is that of the middle of
// the rear axle, from the place and heading of the start; m and rad, x ahead, y to the left.
#pragma once

#include <array>

#include "protocol/plugin/plugin.h"

namespace visum::explorer {

struct Place {
  double x = 0.0, y = 0.0, heading = 0.0;
};

// The place at the end of a piece of an arc, driven forwards or backwards (way < 0).
Place along(const Place& from, double way_m, double curvature);
std::array<double, 2> ahead(const Place& place, double way_m);

class Cart {
 public:
  explicit Cart(plugin::PartLink& part);

  // Gives each wheel the speed, and each steered wheel the angle, with which all of them roll about the same
  // centre (Ackermann).
  void command(double speed_m_s, double curvature);
  void reckon();  // adds what the rear wheels have rolled since the last call
  const Place& place() const { return place_; }

  void reset();
  void save(plugin::StateOut& to) const;
  void load(plugin::StateIn& from);

 private:
  std::array<double, 2> rolled() const;

  plugin::PartLink& part_;
  std::array<std::size_t, 4> speeds_{};
  std::array<std::size_t, 2> steering_{};
  std::array<std::size_t, 2> angles_{};  // of the rear wheels
  bool begun_ = false;
  std::array<double, 2> last_{};
  Place place_;
};

// Three circles along the cart's axis that cover it with its wheels steered (models/cart/cart.urdf); m from
// the rear axle.
inline constexpr std::array kCirclesAt_m{0.0, 0.18, 0.36};
inline constexpr double kCircleRadius_m = 0.27;
inline constexpr double kCentreAt_m = 0.18;
inline constexpr double kMaxCurvature = 1.3;  // 1/m: the inner front wheel at 0.55 rad

}  // namespace visum::explorer
