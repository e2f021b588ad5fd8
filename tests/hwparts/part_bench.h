// A part in closed loop with one plant per joint, ticked by hand.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hwparts/part.h"
#include "tests/hwparts/plant.h"
#include "tests/hwparts/rig.h"

namespace visum::test {

class PartBench {
 public:
  PartBench(const std::string& kind, const hwparts::PartContext& context);

  void tick();
  void run(double seconds);

  // Ports by name. A wrong name throws.
  double& in(const std::string& name);
  double out(const std::string& name) const;
  std::uint32_t module(int number) const;  // Module State
  int part_state() const { return static_cast<int>(out("Part State")); }
  void bump(const std::string& counter) { in(counter) += 1.0; }
  void set_angles(double value);

  std::vector<std::byte> save() const;
  void load(const std::vector<std::byte>& bytes);

  std::unique_ptr<hwparts::Part> part;
  std::vector<double> inputs, outputs;
  std::vector<Plant> plants;
  double tick_s;

 private:
  std::vector<hwparts::JointSample> samples_;
  std::vector<hwparts::JointDrive> drives_;
};

// The arm, with further keys of the part.
inline PartBench arm_bench(const std::string& more = "") {
  return PartBench("amtec_arm", arm_context(0.001, 0.1, 0.017, more));
}

}  // namespace visum::test
