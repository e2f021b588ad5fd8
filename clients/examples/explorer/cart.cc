#include "clients/examples/explorer/cart.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace visum::explorer {
namespace {

// Figures from models/cart/cart.urdf.
constexpr double kWheelRadius_m = 0.08;
constexpr double kWheelbase_m = 0.36;
constexpr double kHalfTrack_m = 0.18;

struct Wheel {
  double x, y;
};
constexpr std::array<Wheel, 4> kWheels{
    {{0.0, kHalfTrack_m}, {0.0, -kHalfTrack_m}, {kWheelbase_m, kHalfTrack_m}, {kWheelbase_m, -kHalfTrack_m}}};

}  // namespace

std::array<double, 2> ahead(const Place& place, double way_m) {
  return {place.x + way_m * std::cos(place.heading), place.y + way_m * std::sin(place.heading)};
}

Place along(const Place& from, double way_m, double curvature) {
  const double turn = way_m * curvature;
  // The chord of the arc lies midway between both headings.
  const double chord = std::abs(turn) > 1e-9 ? way_m * std::sin(turn / 2) / (turn / 2) : way_m;
  const auto [x, y] = ahead({from.x, from.y, from.heading + turn / 2}, chord);
  return {x, y, from.heading + turn};
}

Cart::Cart(plugin::PartLink& part) : part_(part) {
  for (std::size_t i = 0; i < speeds_.size(); ++i)
    speeds_[i] = part.input("Desired Speed " + std::to_string(i + 1));
  for (std::size_t i = 0; i < steering_.size(); ++i)
    steering_[i] = part.input("Desired Angle " + std::to_string(i + 5));
  for (std::size_t i = 0; i < angles_.size(); ++i)
    angles_[i] = part.output("Actual Angle " + std::to_string(i + 1));
}

void Cart::command(double speed_m_s, double curvature) {
  for (std::size_t i = 0; i < kWheels.size(); ++i) {
    const double ahead = 1 - curvature * kWheels[i].y, aside = curvature * kWheels[i].x;
    part_.set(speeds_[i], speed_m_s * std::hypot(ahead, aside) / kWheelRadius_m);
    if (i >= 2) part_.set(steering_[i - 2], std::atan2(aside, ahead));
  }
}

std::array<double, 2> Cart::rolled() const {
  return {kWheelRadius_m * part_.value(angles_[0]), kWheelRadius_m * part_.value(angles_[1])};
}

void Cart::reckon() {
  const auto now = rolled();
  if (begun_) {
    const double left = now[0] - last_[0], right = now[1] - last_[1];
    const double way = (left + right) / 2, turn = (right - left) / (2 * kHalfTrack_m);
    const auto [x, y] = ahead({place_.x, place_.y, place_.heading + turn / 2}, way);
    place_ = {x, y, place_.heading + turn};
  }
  last_ = now;
  begun_ = true;
}

void Cart::reset() {
  begun_ = false;
  last_ = {};
  place_ = {};
}

void Cart::save(plugin::StateOut& to) const {
  to.put(begun_);
  to.put(std::span<const double>(last_));
  to.put(place_.x);
  to.put(place_.y);
  to.put(place_.heading);
}

void Cart::load(plugin::StateIn& from) {
  from.get(begun_);
  from.get(std::span<double>(last_));
  from.get(place_.x);
  from.get(place_.y);
  from.get(place_.heading);
}

}  // namespace visum::explorer
