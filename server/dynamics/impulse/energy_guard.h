// Keeps a limited step (island_limited.cc) from gaining energy. Bodies that touch each other, or hang
// together by joints or springs, are an island: what one gains another may have lost. No island ends a step
// with more energy than it had before, and what drives, wrenches, springs and bodies of other engines can
// have given.
#pragma once

#include "server/dynamics/impulse/plant.h"
#include "server/world/disjoint_sets.h"

namespace visum::dynamics::impulse {

// Order of calls: begin() before anything has changed, hold() where a body's joints cannot be closed, then
// end() after the bodies have moved. Stepper owns it; tick's thread. Nothing here fails.
class EnergyGuard {
 public:
  void begin(const Plant& plant);
  // The body's island will stay where it was before the step, at rest.
  void hold(std::size_t body) { held_[joined_.leader(body)] = 1; }
  // Slows an island down that has gained energy. One that has gained more than its whole motion holds, or
  // whose numbers are not finite, stays where it was. Returns the numbers of the bodies that stay.
  std::vector<std::size_t> end(Plant& plant, std::span<const Wrench> wrenches, double h);

  // For whole steps of linked bodies (stepper_iterate.cc). An island may gain what it has lost shortly
  // before: the energy of a sound step goes up and down. Where contacts, stops, springs or drives push it, it
  // may gain a little more, since they push out what has got too deep. `allowed`: a share of the kinetic
  // energy. True if an island with joints has gained more, or, where nothing pushes it, lost a hundredth of
  // its motion.
  bool is_off(const Plant& plant, std::span<const Wrench> wrenches, double h, double allowed);
  // Takes the gain back by slowing such islands down, at most to rest.
  void take_back(Plant& plant, std::span<const Wrench> wrenches, double h, double allowed);
  // The step is done: keeps what is_off() or take_back() has found for the next one.
  void settle();
  // The losses of the last steps are part of the world's state. Other bytes mean: none.
  std::size_t bytes() const { return sizeof(double) * lost_.size(); }
  void read(std::span<const std::byte> from);
  void write(std::span<std::byte> to) const;
  void start(std::size_t bodies) { lost_.assign(bodies, 0.0); }

 private:
  void join(int a, int b);
  // Adds up what drives, wrenches, springs and bodies of other engines can have given to each island, J.
  void count_given(const Plant& plant, std::span<const Wrench> wrenches, double h);
  double kinetic(const Bodies& bodies, std::size_t body) const;
  // Adds up, by island, what it has gained and what was given to it.
  void measure(const Plant& plant, std::span<const Wrench> wrenches, double h);
  // The gain of an island with joints beyond what it may gain, J; 0 for others.
  double excess(std::size_t island, double h, double allowed) const;
  bool has_lost(std::size_t island) const;

  BodiesMotion before_;
  world::DisjointSets joined_;
  // By body: its kinetic energy before the step, J. The others are by leader, of the island: energies in J,
  // whether anything touches or hangs together there, whether it stays, has joints, and is pushed by bounds.
  std::vector<double> kinetic_before_, gained_, kinetic_after_, given_, size_, weight_, slowed_;
  std::vector<double> rate_before_;  // by axis, rad/s or m/s
  std::vector<double> lost_;         // by leader: J, shortly before this step; empty: not kept
  std::vector<char> bound_, held_, jointed_, pushed_;
};

}  // namespace visum::dynamics::impulse
