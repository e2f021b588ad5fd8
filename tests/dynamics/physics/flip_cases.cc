// F2f: Dzhanibekov's effect. F1n: many boxes, fine steps.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/free_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

using Eigen::Vector3d;

// Incomplete elliptic integral of the first kind, by Simpson's rule.
double elliptic_f(double angle, double k_squared) {
  constexpr int kPieces = 20'000;
  const auto f = [&](double x) { return 1.0 / std::sqrt(1.0 - k_squared * std::sin(x) * std::sin(x)); };
  const double step = angle / kPieces;
  double sum = f(0.0) + f(angle);
  for (int i = 1; i < kPieces; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(i * step);
  return sum * step / 3.0;
}

// The times at which the angular velocity about the middle axis changes its sign: w = -m sn(λ (t - t0)), zero
// at t0 and then after each 2 K / λ. Landau, Lifshitz, Mechanics, section 37; moments A < B < C, L² > 2 E B.
struct Flips {
  Flips(const Vector3d& moments, const Vector3d& w) {  // moments C, B, A, as tossed_box has them
    const double c = moments[0], b = moments[1], a = moments[2];
    const double twice_e = w.cwiseProduct(w).dot(moments), l_squared = w.cwiseProduct(moments).squaredNorm();
    const double rate = std::sqrt((c - b) * (l_squared - twice_e * a) / (a * b * c));
    const double k_squared = (b - a) * (twice_e * c - l_squared) / ((c - b) * (l_squared - twice_e * a));
    const double most = std::sqrt((twice_e * c - l_squared) / (b * (c - b)));
    // With all components of w above zero the middle one falls: B w' = (A - C) w_A w_C.
    first_s = elliptic_f(std::asin(w[1] / most), k_squared) / rate;
    apart_s = 2.0 * elliptic_f(0.5 * std::numbers::pi, k_squared) / rate;
  }
  double first_s, apart_s;
};

std::vector<double> flip(const world::EngineSetting& engine) {
  constexpr double kSeconds = 10.0;
  Lab lab(tumbling_box(engine, 1e-3));
  const auto& motion = lab.state.bodies[0];
  const auto middle = [&] { return (motion.q_WB.conjugate() * motion.w_WB).y(); };
  const Flips exact(lab.model.bodies[0].inertia_C.diagonal(), motion.q_WB.conjugate() * motion.w_WB);
  std::vector<double> flips_s;
  double before = middle();
  watch(lab, kSeconds, [&] {
    const double now = middle();
    if (before * now < 0.0)
      flips_s.push_back(lab.tick_s() * (static_cast<double>(lab.state.tick) - now / (now - before)));
    before = now;
  });
  const int expected = 1 + static_cast<int>((kSeconds - exact.first_s) / exact.apart_s);
  double late = 0.0;
  for (std::size_t i = 0; i < flips_s.size(); ++i)
    late = std::max(late, std::abs(flips_s[i] - exact.first_s - static_cast<double>(i) * exact.apart_s));
  if (flips_s.size() < 2) throw std::runtime_error("it does not turn over");
  const double apart = (flips_s.back() - flips_s.front()) / static_cast<double>(flips_s.size() - 1);
  return {std::abs(static_cast<double>(flips_s.size()) - expected), late,
          std::abs(apart / exact.apart_s - 1.0)};
}

// The worst among `count` boxes that start alike.
void add_worst(const world::EngineSetting& engine, double tick_s, int count, std::vector<double>& worst) {
  auto model = tumbling_box(engine, tick_s);
  for (int i = 1; i < count; ++i) {
    model.bodies.push_back(model.bodies.front());
    model.bodies.back().name = "box_" + std::to_string(i);
  }
  const std::vector<Toss> tosses = toss(std::move(model));
  for (const Toss& one : tosses) {
    const double figures[] = {one.momentum, one.energy, one.com_m, angle_between(tumbled(), one.R)};
    for (std::size_t i = 0; i < worst.size(); ++i) worst[i] = std::max(worst[i], figures[i]);
  }
}

std::vector<double> tumble_finely(const world::EngineSetting& engine) {
  std::vector<double> worst(4, 0.0);
  add_worst(engine, 1e-4, 1, worst);
  add_worst(engine, 5e-4, 1, worst);
  add_worst(engine, 1e-3, 11, worst);
  return worst;
}

std::vector<double> tumble_in_crowds(const world::EngineSetting& engine) {
  std::vector<double> worst(4, 0.0);
  for (const double tick_s : {1e-4, 2e-4, 5e-4, 1e-3}) add_worst(engine, tick_s, 101, worst);
  return worst;
}

}  // namespace

std::vector<Case> flip_cases() {
  const std::vector<Figure> tumbled{
      {"momentum", 1e-12}, {"energy", 1e-5}, {"com_m", 1e-8}, {"orientation_rad", 1e-3}};
  return {
      {"F2f",
       "FreeBoxTurnsOver",
       "closed form: elliptic functions (Landau, Lifshitz, Mechanics, section 37)",
       {{"flips", 0.0}, {"flip_s", 1e-4}, {"period", 1e-4}},
       flip},
      {"F1h", "ElevenBoxesTumble", "as F2, steps of 0.1, 0.5 and 1 ms", tumbled, tumble_finely},
      {"F1n", "HundredAndOneBoxesTumble", "as F2, steps of 0.1 to 1 ms", tumbled, tumble_in_crowds, true},
  };
}

}  // namespace visum::physics
