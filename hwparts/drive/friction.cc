#include "hwparts/drive/friction.h"

#include <cmath>

#include "hwparts/drive/portable_tanh.h"

namespace visum::drive {

double friction_effort(const GearData& gear, double speed) {
  return gear.viscous_friction * speed + gear.coulomb_friction * portable_tanh(speed / gear.coulomb_speed);
}

double friction_secant(const GearData& gear, double speed) {
  const double ratio = std::abs(speed) / gear.coulomb_speed;
  const double slope = ratio < 1e-8 ? 1.0 : portable_tanh(ratio) / ratio;  // tanh(x) / x is 1 - x²/3 near 0
  return gear.viscous_friction + gear.coulomb_friction / gear.coulomb_speed * slope;
}

}  // namespace visum::drive
