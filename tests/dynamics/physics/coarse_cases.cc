// P5: steps that are coarse for the motion.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

using Eigen::Vector3d;

// M. Müller's pendulum challenge: three links of 0.3 m with 1 kg at their ends, g 10 m/s², pictures 1/60 s
// apart, let go from level. Each end has the moment of inertia of a ball of 5 cm.
constexpr double kLinkReach = 0.3, kDown = 10.0, kBall = 1e-3, kPicture = 1.0 / 60.0;
constexpr int kLinks = 3;

world::WorldModel three_links(const world::EngineSetting& engine) {
  std::vector<Link> links;
  for (int i = 0; i < kLinks; ++i)
    links.push_back({{0.0, 0.0, i == 0 ? 0.0 : -kLinkReach},
                     Vector3d::UnitY(),
                     1.0,
                     {0.0, 0.0, -kLinkReach},
                     Vector3d::Constant(kBall),
                     i == 0 ? 0.5 * std::numbers::pi : 0.0});
  auto model = serial_model(engine, kPicture, links);
  model.gravity = {0.0, 0.0, -kDown};
  return model;
}

// Lagrange's equations of the links' angles q from the vertical:
//   Σ_j (m_ij l² cos(q_i - q_j) + J [i = j]) q_j'' = -Σ_j m_ij l² sin(q_i - q_j) q_j'² - m_ii g l sin q_i
// m_ij the mass from link max(i, j) on.
Vector3d acceleration(const Vector3d& q, const Vector3d& w) {
  Eigen::Matrix3d mass;
  Vector3d load;
  for (int i = 0; i < kLinks; ++i) {
    load[i] = -(kLinks - i) * kDown * kLinkReach * std::sin(q[i]);
    for (int j = 0; j < kLinks; ++j) {
      const double m = (kLinks - std::max(i, j)) * kLinkReach * kLinkReach;
      mass(i, j) = m * std::cos(q[i] - q[j]) + (i == j ? kBall : 0.0);
      load[i] -= m * std::sin(q[i] - q[j]) * w[j] * w[j];
    }
  }
  return mass.inverse() * load;
}

// By RK4 in steps of 1/60000 s.
Vector3d exact_end(double time_s) {
  constexpr double kStep = kPicture / 1000.0;
  Vector3d q = Vector3d::Constant(0.5 * std::numbers::pi), w = Vector3d::Zero();
  for (long i = std::lround(time_s / kStep); i > 0; --i) {
    const Vector3d a1 = acceleration(q, w), w2 = w + 0.5 * kStep * a1;
    const Vector3d a2 = acceleration(q + 0.5 * kStep * w, w2), w3 = w + 0.5 * kStep * a2;
    const Vector3d a3 = acceleration(q + 0.5 * kStep * w2, w3), w4 = w + kStep * a3;
    const Vector3d a4 = acceleration(q + kStep * w3, w4);
    q += kStep / 6.0 * (w + 2.0 * w2 + 2.0 * w3 + w4);
    w += kStep / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  Vector3d end = Vector3d::Zero();
  for (int i = 0; i < kLinks; ++i) end += kLinkReach * Vector3d(-std::sin(q[i]), 0.0, -std::cos(q[i]));
  return end;
}

std::vector<double> swing_three_links(const world::EngineSetting& engine) {
  constexpr double kCompared = 0.5, kSeconds = 10.0;
  Lab lab(three_links(engine));
  const double energy = energy_of(lab.model, lab.state), scale = energy_scale(lab.model);
  double drift = 0.0, gap = 0.0;
  const auto look = [&] {
    drift = std::max(drift, std::abs(energy_of(lab.model, lab.state) - energy) / scale);
    gap = std::max(gap, max_gap(lab.model, lab.state));
  };
  watch(lab, kCompared, look);
  const Vector3d end = point_of(lab.model, lab.state, {kLinks - 1}, {0.0, 0.0, -kLinkReach});
  // A tick is whole nanoseconds.
  const double off = (end - exact_end(lab.tick_s() * static_cast<double>(lab.state.tick))).norm();
  watch(lab, kSeconds - kCompared, look);
  return {off, drift, gap};
}

}  // namespace

std::vector<Case> coarse_cases() {
  return {
      {"P5",
       "ThreeLinksSwingIn60thsOfASecond",
       "M. Müller's pendulum challenge; Lagrange's equations by RK4 in steps of 1/60000 s, and E constant",
       {{"end_05s_m", 1e-2}, {"energy", 1e-2}, {"gap_m", 1e-5}},
       swing_three_links},
  };
}

}  // namespace visum::physics
