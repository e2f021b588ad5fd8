// The constants of one servo: motor, gear, encoder, brake, limits, loop. They are read from a drives file, in
// which every key carries its unit. models/amtec_arm/drives.yaml is an example with the source of every
// figure.
//
// Coordinates: everything behind the gear is in the *module's coordinate*: rad for a rotary drive, m for a
// linear one. [u] below is that unit; [F] is N·m or N. A drive that moves n joints alike (a gripper) uses the
// sum of the joints' positions as its coordinate.
#pragma once

#include <cstddef>
#include <string>

#include "protocol/config/config.h"

namespace visum::drive {

inline constexpr std::size_t kMaxJointsPerDrive = 4;
inline constexpr double kHighestSupply_v = 60.0;  // of the parameter Supply Voltage, and of drives files

struct MotorData {
  double torque_constant = 0.0;     // N·m/A at the motor's shaft; also the back-EMF constant in V·s/rad
  double resistance = 0.0;          // ohm, terminal to terminal, with the amplifier's
  double current_limit = 0.0;       // A
  double nominal_current = 0.0;     // A, can flow forever
  double peak_time = 0.0;           // s that current_limit can flow, from rest, before I²t is used up
  double thermal_resistance = 0.0;  // K/W, winding to surroundings
  double thermal_time = 0.0;        // s, time constant of the winding's temperature
  double ambient = 0.0;             // °C
  double maximum_winding = 0.0;     // °C
};

struct GearData {
  double ratio = 0.0;             // motor rad per [u]
  double rotor_inertia = 0.0;     // kg·m² at the motor's shaft
  double viscous_friction = 0.0;  // [F]/([u]/s)
  double coulomb_friction = 0.0;  // [F], times tanh(speed / coulomb_speed)
  double coulomb_speed = 1.0;     // [u]/s
  double dry_friction = 0.0;      // [F], Coulomb's law: of one size while it slides, and holds at rest
  double static_friction = 0.0;   // [F], >= dry_friction, what it holds at rest
  double stiffness = 0.0;         // [F]/[u]; 0: rigid
  double damping = 0.0;           // [F]/([u]/s), of the gear's torsion
  double backlash = 0.0;          // [u], whole width of the play
  double peak_effort = 0.0;       // [F], rating: each time it is exceeded counts as an overload
  double breaking_effort = 0.0;   // [F], the gear never transmits more
};

struct EncoderData {
  double increments_per_turn = 0.0;  // per turn of the motor
};

struct BrakeData {
  bool present = false;
  double holding_effort = 0.0;  // [F] at the output
  double release_time = 0.0;    // s
  double engage_time = 0.0;     // s
};

struct LimitData {
  double maximum_speed = 0.0;         // [u]/s
  double maximum_acceleration = 0.0;  // [u]/s²
  double stop_deceleration = 0.0;     // [u]/s², for Halt, faults that stop on a ramp, and Execution Enable 0
  double following_error = 0.0;       // [u]
  double tolerance = 0.0;             // [u] beyond a limit before it trips, so that standing at it does not
  bool limited = false;               // false: the four below are not used
  double soft_minimum = 0.0;          // [u]
  double soft_maximum = 0.0;
  double hard_minimum = 0.0;
  double hard_maximum = 0.0;
};

struct LoopData {
  double position_gain = 0.0;       // 1/s
  double velocity_bandwidth = 0.0;  // 1/s, of the velocity loop around the bare rotor
  double integral_time = 0.0;       // s, of the velocity loop; 0: no integral part
  double speed_filter = 0.0;        // s, time constant of the measured speed's low pass
  double period = 0.0;              // s, a whole number of ticks; 0: the loop runs in each tick
};

struct HomeData {
  double position = 0.0;  // [u]
  double speed = 0.0;     // [u]/s
};

struct SupplyData {
  double nominal_voltage = 0.0;  // V
  double minimum_voltage = 0.0;  // V, below it the module switches off
};

struct DriveData {
  std::string type;  // "PRL120"
  int module = 0;    // id on the bus
  bool linear = false;
  bool speed_controlled = false;  // the command's target is a speed, [u]/s, instead of a position
  MotorData motor;
  GearData gear;
  EncoderData encoder;
  BrakeData brake;
  LimitData limits;
  LoopData loop;
  HomeData home;
  SupplyData supply;

  double effort_per_amp() const { return motor.torque_constant * gear.ratio; }                  // [F]/A
  double loop_period(double tick_s) const { return loop.period > 0.0 ? loop.period : tick_s; }  // s
  double reflected_inertia() const { return gear.rotor_inertia * gear.ratio * gear.ratio; }  // kg·m² or kg
  double increment() const;                                                                  // [u]
};

// The drive's joint as the model describes it, for what a file with a servo class leaves out. Sums, where the
// drive moves several joints.
struct JointBounds {
  double lower = 1.0;  // lower > upper: no stops
  double upper = -1.0;
  double maximum_speed = 0.0;  // [u]/s; 0: the model gives none
  int number = 1;              // of the drive in its file, from 1
};

// Reads and checks one entry of a drives file. `linear`: the drive's joints are sliders. Throws ConfigError,
// which names all keys that are missing.
DriveData read_drive_data(const config::Node& entry, bool linear, const JointBounds& joint = {});

}  // namespace visum::drive
