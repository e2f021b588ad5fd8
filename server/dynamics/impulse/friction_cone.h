// Coulomb's cone: the friction's impulse p_t, against the normal one p_n, with |p_t| <= mu p_n in every
// direction alike. A disc, not a pyramid: a diagonal slide stops where one along an axis does.
#pragma once

#include <array>
#include <cmath>

namespace visum::dynamics::impulse {

using Tangential = std::array<double, 2>;

// The point of the disc that is nearest to p.
inline Tangential within_disc(const Tangential& p, double radius) {
  const double length = std::sqrt(p[0] * p[0] + p[1] * p[1]);
  if (length <= radius) return p;
  const double scale = radius > 0.0 ? radius / length : 0.0;
  return {p[0] * scale, p[1] * scale};
}

inline bool is_within_disc(const Tangential& p, double radius) {
  return p[0] * p[0] + p[1] * p[1] <= radius * radius;
}

}  // namespace visum::dynamics::impulse
