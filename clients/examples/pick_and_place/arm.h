// The arm as its controller sees it: the ports of one hardware part, written and read once per period. It
// knows nothing of the world. It lives on the controller's one thread. A fault of a drive, a Ctrl-C and a
// lost connection end the present motion by an exception.
#pragma once

#include <csignal>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "clients/cpp/visum.h"
#include "clients/examples/pick_and_place/trajectory.h"

namespace visum::pick_and_place {

inline constexpr double kPeriod_ms = 10.0;

// A drive reported an error; what() names it, with its state word.
class DriveFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The user wants the program to end.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

class Arm {
 public:
  // Takes the part's lease and joins the clock. `joints` and `fingers` are the model's numbers; a part with
  // other numbers throws visum::Error. A signal handler sets `stop`, and tick() checks it.
  Arm(visum::Client& client, const std::string& part, std::size_t joints, std::size_t fingers,
      const volatile std::sig_atomic_t& stop);

  double time_s() const;                   // since construction, simulated
  Eigen::VectorXd angles() const;          // rad
  Eigen::VectorXd maximum_speeds() const;  // the drives' own, rad/s
  const Eigen::VectorXd& ramp_accelerations() const { return ramp_accelerations_; }  // of the drives, rad/s²
  std::vector<double> finger_positions() const;
  double largest_finger_speed() const;     // m/s, magnitude
  double maximum_finger_speed() const;     // the drive's own
  double largest_following_error() const;  // rad, commanded minus actual, over all ticks so far

  // Commands for the drives in the coming period. `next` is the trajectory's state at its end.
  void command(const MotionState& next);
  void command_fingers(double position, double maximum_speed);

  // Writes the commands and waits for the end of the period. Throws DriveFault, Interrupted or visum::Error.
  void tick();

  // Stops as fast as the drives' ramps allow, writes that, and gives the part back.
  void hold_and_release();
  void release();

 private:
  void check_drives();
  double braking_distance(std::size_t joint, double speed) const;

  visum::Client& client_;
  visum::Part part_;
  const volatile std::sig_atomic_t& stop_;
  visum::Inputs desired_angle_, maximum_speed_, desired_finger_, maximum_finger_speed_;
  visum::Outputs actual_angle_, actual_speed_, actual_finger_, actual_finger_speed_, module_state_;
  Eigen::VectorXd ramp_accelerations_;
  Eigen::VectorXd commanded_;  // rad, the present point of the trajectory
  double largest_error_ = 0.0;
  std::int64_t start_ns_ = 0;
};

}  // namespace visum::pick_and_place
