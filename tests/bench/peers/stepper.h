// One world, ready to be stepped by one engine, ours or another one. The physics benchmarks compare them.
#pragma once

#include <memory>
#include <string>

#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::bench {

class Stepper {
 public:
  virtual ~Stepper() = default;
  virtual void reset() = 0;  // back to the model's initial state
  virtual void step() = 0;   // one tick of the model; collision included where there are shapes
  virtual void store(world::WorldState& state) const = 0;  // the bodies' motions (velocities: at their coms)
  virtual int warned_ticks() const { return 0; }           // since it was made; peers do not warn
};

struct StepperKind {
  std::string name;  // as in Step/arm7/<name>
  bool (*takes)(const world::WorldModel& model);
  std::unique_ptr<Stepper> (*make)(const world::WorldModel& model, const std::string& name);
};

// The kinds of our models that other engines can take.
bool is_open_chain(const world::WorldModel& model);  // hinges only, no loop, no shape
bool is_mechanism(const world::WorldModel& model);   // hinges only, loops allowed, no shape
bool is_boxes_only(const world::WorldModel& model);  // free boxes on a plane, no joint
// Boxes and spheres on a plane that hinges, balls and fixed joints hold; loops allowed, and springs beside
// hinges.
bool is_jointed_scene(const world::WorldModel& model);
bool has_springs(const world::WorldModel& model);

}  // namespace visum::bench
