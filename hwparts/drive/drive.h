// One servo at work. Per tick, on the tick's thread: act() before the engines' step, publish() after it. No
// allocation.
#pragma once

#include <cstdint>
#include <span>

#include "hwparts/drive/broken.h"
#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/drive_state.h"
#include "hwparts/drive/gear.h"
#include "hwparts/joint.h"

namespace visum::drive {

// What a drive is told, every tick. Module's coordinate. A speed-controlled one goes at `target` [u]/s.
struct Command {
  double target = 0.0;
  double maximum_speed = 0.0;  // above the drive's own: the drive's own
  bool enabled = true;         // false: stop on a ramp and stand
};

class Drive {
 public:
  // At rest, all its joints at the same position that adds up to `position`.
  Drive(const DriveData& data, double position, bool homed, double tick_s);

  void act(const Command& command, std::span<const hwparts::JointSample> joints,
           std::span<hwparts::JointDrive> drives);
  // Without an act() before it (before the first tick, after a restore), only takes notice of where the
  // joints are. `encoder_noise`: what this reading is off by, [u].
  void publish(std::span<const hwparts::JointSample> joints, double encoder_noise = 0.0);
  // From now on; {} is whole again. What it did to the state (heat, a gear that slipped) stays.
  void set_broken(const Broken& broken) { broken_ = broken; }
  const Broken& broken() const { return broken_; }
  // Back to the state after construction.
  void restart();

  const DriveData& data() const { return data_; }
  const DriveState& state() const { return state_; }
  DriveState& state() { return state_; }
  void load(hwparts::StateReader& from);

 private:
  void move_setpoint(const Command& command);
  void home_on(const Command& command);
  Setpoint follow_ports(const Command& command);
  Setpoint follow_bus();
  Setpoint stopping_inside(const Setpoint& next, double target, const MotionLimits& limits) const;
  Setpoint keep_speed(double speed, const MotionLimits& limits);
  MotorEffort drive_motor();
  bool brake_holds() const;
  double encoder(double noise) const;

  DriveData data_;
  double tick_s_;
  DriveState initial_;
  DriveState state_;
  Broken broken_;
  RotorPlan plan_;      // from act() to publish() of the same tick
  bool acted_ = false;  // plan_ holds
};

}  // namespace visum::drive
