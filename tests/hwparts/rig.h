// A drive in closed loop with its plants, ticked by hand. Also reads the drives of the arm's own file.
#pragma once

#include <cstdint>
#include <vector>

#include "hwparts/drive/drive.h"
#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"
#include "hwparts/servo_group/drive_list.h"
#include "tests/hwparts/plant.h"

namespace visum::test {

namespace bit = drive::state_bit;

// models/amtec_arm/drives.yaml, bound to joints that start at `angle` and fingers that start at `finger`.
hwparts::PartContext arm_context(double tick_s = 0.001, double angle = 0.0, double finger = 0.017,
                                 const std::string& more = "");
// The data of drive 1..8 of the arm.
drive::DriveData arm_drive(int number);
// The same drive without backlash, torsion, friction and filter, so that closed forms are exact.
drive::DriveData ideal(drive::DriveData data);

struct Rig {
  // `load`: as the scene knows it; the plants move so, and share its inertia where it is known (plant.h).
  explicit Rig(const drive::DriveData& data, double tick_s = 0.001, double position = 0.0,
               std::size_t joints = 1, const drive::Load& load = {});

  void tick();
  void run(double seconds);
  std::uint32_t word() const { return drive::state_word(drive.state()); }
  bool has(std::uint32_t bits) const { return (word() & bits) == bits; }
  const drive::DriveState& state() const { return drive.state(); }
  double position() const { return plants[0].joint.position; }
  // Reset and Halt, with the target that the next tick will bring.
  void reset() { drive.latch(command.target), drive.reset(); }
  void halt() { drive.latch(command.target), drive.halt(); }
  void supply(double volts) { drive.tune(&drive::Tuning::supply_voltage, volts); }
  // Puts the drive into another state, as a snapshot does.
  void put(const drive::DriveState& state);

  double tick_s;
  drive::Drive drive;
  std::vector<Plant> plants;
  drive::Command command;

 private:
  std::vector<hwparts::JointSample> samples_;
  std::vector<hwparts::JointDrive> drives_;
};

}  // namespace visum::test
