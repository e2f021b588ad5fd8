// Keeps a limited step (stepper_limited.cc) from gaining energy. Bodies that touch each other, or hang
// together by joints or springs, are an island: what one gains another may have lost. No island ends a step
// with more energy than it had before, and what drives, wrenches, springs and bodies of other engines can
// have given.
#pragma once

#include "server/dynamics/disjoint_sets.h"
#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {

// Order of calls: begin() before anything has changed, hold() where a body's joints cannot be closed, then
// end() after the bodies have moved. Stepper owns it; tick's thread. Nothing here fails.
class EnergyGuard {
 public:
  void begin(const Plant& plant);
  // The body's island will stay where it was before the step, at rest.
  void hold(std::size_t body) { held_[joined_.leader(body)] = 1; }
  void release() { std::fill(held_.begin(), held_.end(), 0); }  // takes all hold() back
  // Slows an island down that has gained energy. One that has gained more than its whole motion holds, or
  // whose numbers are not finite, stays where it was. Returns the numbers of the bodies that stay.
  std::vector<std::size_t> end(Plant& plant, std::span<const Wrench> wrenches, double h);

 private:
  void join(int a, int b);
  // Adds up what drives, wrenches, springs and bodies of other engines can have given to each island, J.
  void count_given(const Plant& plant, std::span<const Wrench> wrenches, double h);
  double kinetic(const Bodies& bodies, std::size_t body) const;

  BodiesMotion before_;
  DisjointSets joined_;
  // By body: its kinetic energy before the step, J. The others are by leader, of the island: energies in J,
  // whether anything touches or hangs together there, and whether it stays.
  std::vector<double> kinetic_before_, gained_, kinetic_after_, given_, size_;
  std::vector<double> rate_before_;  // by axis, rad/s or m/s
  std::vector<char> bound_, held_;
};

}  // namespace visum::dynamics::impulse
