// One servo at work: motor, gear, encoder, brake and the loop around them, as one PowerCube module holds
// them.
//
// A part owns its drives by value; they live on the tick's thread. Order of calls: per tick act() before the
// engines' step and publish() after it. All commands below come between ticks, or in the tick before act().
// Nothing fails, and nothing allocates: a fault of the servo is a bit of its state word (state_word.h).
//
// Only the drive writes its state. Others read state() and change the drive by its commands.
#pragma once

#include <cstdint>
#include <span>

#include "hwparts/drive/broken.h"
#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/drive_state.h"
#include "hwparts/drive/gear.h"
#include "hwparts/drive/servo_loop.h"
#include "hwparts/drive/trip.h"
#include "hwparts/joint.h"

namespace visum::drive {

// The ports' command to a drive, given in every tick. In the module's coordinate.
struct Command {
  double target = 0.0;         // [u], or [u]/s for a speed-controlled drive
  double maximum_speed = 0.0;  // [u]/s; above the drive's own maximum, that maximum holds
  bool enabled = true;         // false: the drive stops on a ramp and stands
};

class Drive {
 public:
  // Starts at rest. All its joints stand at the same position, and these positions add up to `position`.
  Drive(const DriveData& data, double position, bool homed, double tick_s, const Load& load);

  // ---- the tick ----

  void act(const Command& command, std::span<const hwparts::JointSample> joints,
           std::span<hwparts::JointDrive> drives);
  // Without an act() before it (before the first tick, after a restore) it only notes where the joints are.
  // `encoder_noise` [u] is added to this one reading.
  void publish(std::span<const hwparts::JointSample> joints, double encoder_noise = 0.0);

  // ---- commands of ports and bus alike ----

  // Notes the ports' target that the next act() will bring. A bus command, Halt, Reset and hold() that come
  // first hold against this target: the drive follows the ports again once it differs.
  void latch(double target);
  // Clears the faults whose cause is gone (supervision.h), and ends a Halt.
  void reset();
  // Stops on a ramp. Only reset() ends it.
  void halt();
  // Stands until the ports' target differs from the latched one.
  void hold();
  // Faults with COMM_ERROR and stops on a ramp.
  void lose_controller();
  // Switches the power stage off without a fault; the brake falls in. reset() closes the loop again.
  void open_loop();

  // ---- commands of the ports ----

  // Goes to the reference switch, for the ports. Does nothing while a fault stands or the loop is open.
  void home();
  // Ends a homing that the ports asked for. One that the bus asked for goes on.
  void cancel_homing_of_ports();

  // ---- commands of the field bus: they hold until the ports' target becomes another one ----

  // False, with nothing changed: a fault stands or the loop is open.
  bool home_by_bus();
  void halt_by_bus();
  void move_by_bus(const Motion& motion);
  // Starts a step to `target` [u] at once.
  void step_by_bus(double target, double duration_s);
  // Queues a step behind the running one, in place of a step that is queued already.
  void queue_step(double target, double duration_s);
  // Cuts the running step short and starts the queued one.
  void start_queued_step();
  // Sets the warning CUR_LIMIT, for a commanded current that was cut to what is allowed.
  void warn_of_current_limit();

  // ---- settings ----

  // Sets one field of the tuning. The caller checks the bounds.
  void tune(double Tuning::*field, double value);
  // [u]. Takes effect with the next homing or apply_home_offset().
  void set_home_offset(double offset);
  // Puts a changed home offset in force without homing. Moves nothing.
  void apply_home_offset();
  // True: homing ends with a move to 0.
  void set_zero_after_home(bool moves);
  // Sets or clears HOME_OK, as the module comes up.
  void set_homed(bool homed);
  // The encoder reads 0 here, and the soft limits mean nothing until the drive is homed.
  void count_from_here();
  // Breaks the drive from now on; {} makes it whole again. Damage to the state (heat, a gear that slipped)
  // stays.
  void set_broken(const Broken& broken) { broken_ = broken; }

  // The joints were put elsewhere: the rotor is there, too, and the drive brakes on its ramp from the speed
  // that they have. It stands until the ports' target becomes another one.
  void place(std::span<const hwparts::JointSample> joints);

  // Back to the state after construction. `broken` stays.
  void restart();
  void save(hwparts::StateWriter& to) const;
  void load(hwparts::StateReader& from);

  const Broken& broken() const { return broken_; }
  const DriveData& data() const { return data_; }
  const DriveState& state() const { return state_; }
  // The last trip, and how many there were since construction. A restart or a restore keeps both.
  const Trip& trip() const { return trip_; }
  std::uint64_t trips() const { return trips_; }

 private:
  // Each of these gives or makes the setpoint of this run of the loop.
  void move_setpoint(const Command& command);
  void home_on(const Command& command);
  Setpoint follow_ports(const Command& command);
  Setpoint follow_bus();
  Setpoint stopping_inside(const Setpoint& next, double target, const MotionLimits& limits) const;
  Setpoint keep_speed(double speed, const MotionLimits& limits);
  // Runs the servo loop where it is due, and sets the motor's current.
  MotorEffort drive_motor(bool loop_runs);
  CurrentCommand command_current(const CurrentWindow& window, bool loop_runs) const;
  // True where the brake really holds: a stuck brake does not do what the module says.
  bool brake_holds() const;
  // The encoder's reading now, faults and noise included.
  double encoder(double noise) const;
  void show_motion();
  // Takes down the faults that are new in this tick, with the figures from before it.
  void note_trip(const Trip& before);
  MotionLimits motion_limits() const;

  DriveData data_;
  double tick_s_;
  bool by_mean_speed_;  // so the joints move
  GearPlaces places_;
  double period_s_;           // of the servo loop
  std::uint32_t loop_ticks_;  // the same in ticks
  DriveState initial_;
  DriveState state_;
  Broken broken_;
  Trip trip_;
  std::uint64_t trips_ = 0;
  std::uint32_t known_ = 0;  // the bits that were latched at the end of the last act()
  RotorPlan plan_;           // from act() to publish() of the same tick
  bool acted_ = false;       // plan_ holds
};

}  // namespace visum::drive
