// L: closed loops.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/physics/andrews.h"
#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

std::vector<double> turn_four_bars(const world::EngineSetting& engine) {
  Lab lab(four_bars(engine, 1e-3, 2));
  const double energy = energy_of(lab.model, lab.state);
  double drift_j = 0.0, gap = 0.0, before = 0.0;
  std::vector<double> figures;
  for (const TipAt& tip : four_bars_tips()) {
    watch(lab, tip.time_s - before, [&] {
      drift_j = std::max(drift_j, std::abs(energy_of(lab.model, lab.state) - energy));
      gap = std::max(gap, max_gap(lab.model, lab.state));
    });
    before = tip.time_s;
    if (tip.time_s == 1.0 || tip.time_s == 10.0)
      figures.push_back((point_of(lab.model, lab.state, {0}, kFourBarsB0) - tip.p_W).norm());
  }
  figures.push_back(drift_j);
  figures.push_back(gap);
  return figures;
}

// {B0's error at the end, energy's, gap}
std::vector<double> turn_many(const world::EngineSetting& engine, int loops, double seconds) {
  Lab lab(four_bars(engine, 1e-3, loops));
  const double energy = energy_of(lab.model, lab.state);
  double drift_j = 0.0, gap = 0.0;
  watch(lab, seconds, [&] {
    drift_j = std::max(drift_j, std::abs(energy_of(lab.model, lab.state) - energy));
    gap = std::max(gap, max_gap(lab.model, lab.state));
  });
  const auto tip = point_of(lab.model, lab.state, {0}, kFourBarsB0);
  return {(tip - four_bars_tip(loops, seconds)).norm(), drift_j, gap};
}

std::vector<double> turn_four_and_ten(const world::EngineSetting& engine) {
  std::vector<double> figures = turn_many(engine, 4, 2.0);
  for (const double figure : turn_many(engine, 10, 1.0)) figures.push_back(figure);
  return figures;
}

std::vector<double> turn_forty_four_bars(const world::EngineSetting& engine) {
  return turn_many(engine, 40, 1.0);
}

std::vector<double> squeeze(const world::EngineSetting& engine) {
  Lab lab(andrews(engine, 5e-5));
  lab.drive("crank").feedforward = kAndrewsTorque;
  double worst = 0.0, gap = 0.0, before = 0.0, beta = 0.0;
  for (const AndrewsPoint& point : andrews_points()) {
    watch(lab, point.time_s - before, [&] { gap = std::max(gap, max_gap(lab.model, lab.state)); });
    before = point.time_s;
    worst = std::max(worst, (andrews_f(lab.model, lab.state) - point.f_W).norm());
    if (point.time_s == kAndrewsBetaAt_s) beta = std::abs(andrews_beta(lab.state) - kAndrewsBeta);
  }
  return {worst, beta, gap};
}

std::vector<double> fold_bricard_for(const world::EngineSetting& engine, double seconds) {
  Lab lab(bricard(engine, 1e-3));
  const double energy = energy_of(lab.model, lab.state), scale = energy_scale(lab.model);
  double drift = 0.0, gap = 0.0, kinetic_j = 0.0;
  watch(lab, seconds, [&] {
    drift = std::max(drift, std::abs(energy_of(lab.model, lab.state) - energy) / scale);
    gap = std::max(gap, max_gap(lab.model, lab.state));
    kinetic_j = std::max(kinetic_j, lab.kinetic_energy());
  });
  // By counting it has no freedom, and an engine that believes so leaves it where it is.
  return {drift, gap, kinetic_j > 1.0 ? 0.0 : 1.0};
}

std::vector<double> fold_bricard(const world::EngineSetting& engine) {
  return fold_bricard_for(engine, 2.0);
}

std::vector<double> fold_bricard_on(const world::EngineSetting& engine) {
  return fold_bricard_for(engine, 10.0);
}

std::vector<double> govern(const world::EngineSetting& engine) {
  Lab lab(governor(engine, 1e-3));
  double angle = 0.0, slide_m = 0.0, gap = 0.0, before = 0.0;
  for (const GovernorAt& pose : governor_poses()) {
    watch(lab, pose.time_s - before, [&] { gap = std::max(gap, max_gap(lab.model, lab.state)); });
    before = pose.time_s;
    for (const char* hinge : {"left_hinge", "right_hinge"})
      angle = std::max(angle, std::abs(lab.joint(hinge).position + std::numbers::pi / 6.0 - pose.angle));
    slide_m = std::max(slide_m, std::abs(-lab.body("slider").p_WC.z() - pose.slide_m));
  }
  return {angle, slide_m, gap};
}

}  // namespace

std::vector<Case> loop_cases() {
  return {
      {"L1",
       "FourBarsTurn",
       "IFToMM A02, two loops; one degree of freedom integrated to 1e-12",
       {{"b0_1s_m", 1e-5}, {"b0_10s_m", 2e-3}, {"energy_j", 3e-3}, {"gap_m", 1e-10}},
       turn_four_bars},
      {"L1n",
       "FortyFourBarsTurn",
       "IFToMM A02, forty loops; one degree of freedom integrated to 1e-12",
       {{"b0_1s_m", 1e-5}, {"energy_j", 6e-2}, {"gap_m", 1e-10}},  // as L1, for twenty times the bars
       turn_forty_four_bars,
       true},
      {"L1m",
       "FourAndTenFourBarsTurn",
       "IFToMM A02, four and ten loops; one degree of freedom integrated to 1e-12",
       {{"b0_4_2s_m", 1e-4},
        {"energy_4_j", 3e-3},
        {"gap_4_m", 1e-10},
        {"b0_10_1s_m", 1e-5},
        {"energy_10_j", 3e-3},
        {"gap_10_m", 1e-10}},
       turn_four_and_ten},
      {"L2",
       "AndrewsMechanismSqueezes",
       "test set for IVP solvers, Andrews' squeezing mechanism; F integrated by DOP853 at 1e-12, steps of "
       "0.05 ms",
       {{"f_m", 1e-4}, {"beta_30ms_rad", 2e-2}, {"gap_m", 1e-10}},
       squeeze},
      {"L3",
       "BricardMechanismFolds",
       "IFToMM A04; closed form: E constant, gap 0, and it moves",
       {{"energy", 1e-4}, {"gap_m", 1e-10}, {"stuck", 0.0}},
       fold_bricard},
      {"L3t",
       "BricardMechanismFoldsFor10s",
       "IFToMM A04; closed form: E constant, gap 0, and it moves",
       {{"energy", 1e-4}, {"gap_m", 1e-10}, {"stuck", 0.0}},
       fold_bricard_on},
      {"L4",
       "GovernorGoverns",
       "IFToMM A05; its three equations of motion integrated to 1e-15",
       {{"angle_rad", 1e-3}, {"slide_m", 1e-3}, {"gap_m", 1e-10}},
       govern},
  };
}

}  // namespace visum::physics
