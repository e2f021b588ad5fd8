#include "clients/examples/pick_and_place/arm.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace visum::pick_and_place {
namespace {

constexpr std::uint32_t kErrorBit = 0x1;   // of the PowerCube state word: no motion until Reset
constexpr std::uint32_t kHaltedBit = 0x4;  // something has halted it
constexpr double kSpeedHeadroom = 1.05;    // lets a drive catch up that fell behind
constexpr double kLeastSpeed_rad_per_s = 0.01;

struct StateBit {
  std::uint32_t bit;
  const char* meaning;
};
constexpr StateBit kCauses[] = {
    {0x4, "halted"},
    {0x10, "following error too large"},
    {0x20, "controller lost"},
    {0x40000, "no motor supply"},
    {0x80000, "too hot"},
    {0x800000, "overloaded for too long"},
    {0x2000000, "beyond the hard limit"},
    {0x4000000, "beyond the soft limit"},
};

std::string describe_state(std::size_t module, std::uint32_t state) {
  char text[64];
  std::snprintf(text, sizeof text, "module %zu reports a fault (state 0x%x", module, unsigned(state));
  std::string all = text;
  for (const StateBit& cause : kCauses) {
    if ((state & cause.bit) != 0) all += std::string(", ") + cause.meaning;
  }
  return all + ")";
}

void expect_size(std::size_t is, std::size_t should, const char* ports, const std::string& part) {
  if (is == should) return;
  throw visum::Error(visum::ErrorCode::kMisuse,
                     "the model has " + std::to_string(should) + " joints for '" + ports +
                         "', the part has " + std::to_string(is) + " ports",
                     part, ports);
}

Eigen::VectorXd to_eigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
}

Eigen::VectorXd read_ramp_accelerations(const visum::Part& part, std::size_t joints) {
  std::vector<double> values;
  for (std::size_t i = 1; i <= joints; ++i) {
    values.push_back(std::get<double>(part.parameter("Maximum Acceleration " + std::to_string(i))));
  }
  return to_eigen(values);
}

}  // namespace

Arm::Arm(visum::Client& client, const std::string& part, std::size_t joints, std::size_t fingers,
         const volatile std::sig_atomic_t& stop)
    : client_(client),
      part_(client.part(part)),
      stop_(stop),
      desired_angle_(part_.inputs("Desired Angle")),
      maximum_speed_(part_.inputs("Maximum Speed")),
      desired_finger_(part_.inputs("Desired Finger Position")),
      maximum_finger_speed_(part_.inputs("Maximum Finger Speed")),
      actual_angle_(part_.outputs("Actual Angle")),
      actual_speed_(part_.outputs("Actual Speed")),
      actual_finger_(part_.outputs("Actual Finger Position")),
      actual_finger_speed_(part_.outputs("Actual Finger Speed")),
      module_state_(part_.outputs("Module State")) {
  expect_size(desired_angle_.size(), joints, "Desired Angle", part);
  expect_size(desired_finger_.size(), fingers, "Desired Finger Position", part);
  ramp_accelerations_ = read_ramp_accelerations(part_, joints);
  check_drives();
  part_.acquire();
  client_.join();
  part_.read();
  start_ns_ = client_.time_ns();
  commanded_ = angles();
}

double Arm::time_s() const {
  return 1e-9 * double(client_.time_ns() - start_ns_);
}

Eigen::VectorXd Arm::angles() const {
  return to_eigen(actual_angle_.values());
}

Eigen::VectorXd Arm::maximum_speeds() const {
  Eigen::VectorXd speeds(Eigen::Index(maximum_speed_.size()));
  for (std::size_t i = 0; i < maximum_speed_.size(); ++i) {
    speeds[Eigen::Index(i)] = maximum_speed_.info(i).initial;
  }
  return speeds;
}

std::vector<double> Arm::finger_positions() const {
  return actual_finger_.values();
}

double Arm::largest_finger_speed() const {
  return to_eigen(actual_finger_speed_.values()).cwiseAbs().maxCoeff();
}

double Arm::maximum_finger_speed() const {
  return maximum_finger_speed_.info().initial;
}

double Arm::largest_following_error() const {
  return largest_error_;
}

double Arm::braking_distance(std::size_t joint, double speed) const {
  return 0.5 * speed * std::abs(speed) / ramp_accelerations_[Eigen::Index(joint)];
}

void Arm::command(const MotionState& next) {
  for (std::size_t i = 0; i < desired_angle_.size(); ++i) {
    const double speed = next.velocity[Eigen::Index(i)];
    // A drive plans its ramp to stand at the desired angle. To pass a point at a speed, it must be told to
    // stop one braking distance behind it, plus one period. Otherwise it would already brake when the next
    // point comes.
    const double ahead = speed * 1e-3 * kPeriod_ms + braking_distance(i, speed);
    desired_angle_.set(i, next.position[Eigen::Index(i)] + ahead);
    maximum_speed_.set(i, std::min(kSpeedHeadroom * std::abs(speed) + kLeastSpeed_rad_per_s,
                                   maximum_speed_.info(i).initial));
  }
  commanded_ = next.position;
}

void Arm::command_fingers(double position, double maximum_speed) {
  for (std::size_t i = 0; i < desired_finger_.size(); ++i) {
    desired_finger_.set(i, position);
    maximum_finger_speed_.set(i, maximum_speed);
  }
}

void Arm::tick() {
  part_.write();
  client_.advance_ms(kPeriod_ms);
  largest_error_ = std::max(largest_error_, (commanded_ - angles()).cwiseAbs().maxCoeff());
  check_drives();
  if (stop_ != 0) throw Interrupted();
}

void Arm::check_drives() {
  for (std::size_t i = 0; i < module_state_.size(); ++i) {
    const auto state = std::uint32_t(module_state_[i]);
    if ((state & (kErrorBit | kHaltedBit)) != 0) throw DriveFault(describe_state(i + 1, state));
  }
}

void Arm::hold_and_release() {
  for (std::size_t i = 0; i < desired_angle_.size(); ++i) {
    desired_angle_.set(i, actual_angle_[i] + braking_distance(i, actual_speed_[i]));
  }
  part_.write();
  release();
}

void Arm::release() {
  client_.leave();
  part_.release();
}

}  // namespace visum::pick_and_place
