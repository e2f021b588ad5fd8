// visum-mca-motion: the middle of the three parts. It moves all joints of the arm to target angles, so that
// they arrive together.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "clients/mca/part.h"

namespace {

using namespace visum;

constexpr int kJoints = 7;

// Says where the arm is, and whether it is in fault.
class Supervisor : public mca::Module {
 public:
  MCA_SENSOR_INPUT(eSI_ACTUAL_ANGLE_1, eSI_ACTUAL_ANGLE_2, eSI_ACTUAL_ANGLE_3, eSI_ACTUAL_ANGLE_4,
                   eSI_ACTUAL_ANGLE_5, eSI_ACTUAL_ANGLE_6, eSI_ACTUAL_ANGLE_7, eSI_PART_STATE, eSI_DIMENSION);
  MCA_SENSOR_OUTPUT(eSO_ACTUAL_ANGLE_1, eSO_ACTUAL_ANGLE_2, eSO_ACTUAL_ANGLE_3, eSO_ACTUAL_ANGLE_4,
                    eSO_ACTUAL_ANGLE_5, eSO_ACTUAL_ANGLE_6, eSO_ACTUAL_ANGLE_7, eSO_FAULT, eSO_DIMENSION);

  explicit Supervisor(mca::Place place) : Module(place, mca::ports<Supervisor>()) {}

  void Sense() override {
    for (int i = 0; i < kJoints; ++i)
      SensorOutput(eSO_ACTUAL_ANGLE_1 + i) = SensorInput(eSI_ACTUAL_ANGLE_1 + i);
    const bool fault = SensorInput(eSI_PART_STATE) >= least_fault_();
    if (fault && SensorOutput(eSO_FAULT) == 0.0) Debug(1, "fault", "the arm is in fault");
    SensorOutput(eSO_FAULT) = fault ? 1.0 : 0.0;
  }

 private:
  mca::Parameter<double> least_fault_{
      *this, "Least Fault", 2.0, {.help = "a part state from here on is a fault"}};
};

// Goes to the target angles along one smooth curve in time when the number of `Move` changes. `Arrived` then
// shows that number.
class Trajectory : public mca::Module {
 public:
  MCA_CONTROLLER_INPUT(eCI_TARGET_ANGLE_1, eCI_TARGET_ANGLE_2, eCI_TARGET_ANGLE_3, eCI_TARGET_ANGLE_4,
                       eCI_TARGET_ANGLE_5, eCI_TARGET_ANGLE_6, eCI_TARGET_ANGLE_7, eCI_SPEED_SHARE, eCI_MOVE,
                       eCI_DIMENSION);
  MCA_CONTROLLER_OUTPUT(eCO_DESIRED_ANGLE_1, eCO_DESIRED_ANGLE_2, eCO_DESIRED_ANGLE_3, eCO_DESIRED_ANGLE_4,
                        eCO_DESIRED_ANGLE_5, eCO_DESIRED_ANGLE_6, eCO_DESIRED_ANGLE_7, eCO_MAXIMUM_SPEED_1,
                        eCO_MAXIMUM_SPEED_2, eCO_MAXIMUM_SPEED_3, eCO_MAXIMUM_SPEED_4, eCO_MAXIMUM_SPEED_5,
                        eCO_MAXIMUM_SPEED_6, eCO_MAXIMUM_SPEED_7, eCO_DIMENSION);
  MCA_SENSOR_INPUT(eSI_ACTUAL_ANGLE_1, eSI_ACTUAL_ANGLE_2, eSI_ACTUAL_ANGLE_3, eSI_ACTUAL_ANGLE_4,
                   eSI_ACTUAL_ANGLE_5, eSI_ACTUAL_ANGLE_6, eSI_ACTUAL_ANGLE_7, eSI_FAULT, eSI_DIMENSION);
  MCA_SENSOR_OUTPUT(eSO_MOVING, eSO_ARRIVED, eSO_DIMENSION);

  explicit Trajectory(mca::Place place) : Module(place, mca::ports<Trajectory>()) {}

  void Sense() override {
    const bool over = duration_ns_ > 0 && LoopTime() - start_ns_ >= duration_ns_;
    if (SensorOutput(eSO_MOVING) > 0.0 && over && is_there()) {
      SensorOutput(eSO_MOVING) = 0.0;
      SensorOutput(eSO_ARRIVED) = move_;
      Debug(1, "motion", "arrived");
    }
  }

  void Control() override {
    if (SensorInput(eSI_FAULT) > 0.0) return;  // the arm stops by itself; what is desired stays
    if (ControllerInput(eCI_MOVE) != move_) begin();
    if (SensorOutput(eSO_MOVING) == 0.0) return;
    const double share = way_at(LoopTime() + static_cast<std::int64_t>(lead_() * 1e9));
    for (int i = 0; i < kJoints; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      ControllerOutput(eCO_DESIRED_ANGLE_1 + i) = from_[joint] + share * (to_[joint] - from_[joint]);
      ControllerOutput(eCO_MAXIMUM_SPEED_1 + i) = speed_();
    }
  }

 private:
  void begin() {
    move_ = ControllerInput(eCI_MOVE);
    start_ns_ = LoopTime();
    double longest = 0.0;
    for (int i = 0; i < kJoints; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      from_[joint] = SensorInput(eSI_ACTUAL_ANGLE_1 + i);
      to_[joint] = ControllerInput(eCI_TARGET_ANGLE_1 + i);
      longest = std::max(longest, std::abs(to_[joint] - from_[joint]));
    }
    const double share = std::clamp(ControllerInput(eCI_SPEED_SHARE), 0.05, 1.0);
    constexpr double kPeak = 1.875;  // the curve's highest speed, as a multiple of its mean speed
    duration_ns_ = static_cast<std::int64_t>(1e9 * std::max(0.1, kPeak * longest / (share * speed_())));
    SensorOutput(eSO_MOVING) = 1.0;
    show_way();
    Debug(1, "motion", "begins a move");
  }

  // Rows of a time from the start, and the seven angles then.
  void show_way() {
    std::array<std::array<double, 1 + kJoints>, kWayRows> rows{};
    for (std::size_t row = 0; row < kWayRows; ++row) {
      const auto ns = duration_ns_ * static_cast<std::int64_t>(row) / static_cast<std::int64_t>(kWayRows - 1);
      const double share = way_at(start_ns_ + ns);
      rows[row][0] = 1e-9 * static_cast<double>(ns);
      for (std::size_t joint = 0; joint < kJoints; ++joint)
        rows[row][1 + joint] = from_[joint] + share * (to_[joint] - from_[joint]);
    }
    way_.write(std::as_bytes(std::span(rows)));
  }

  // The share of the way at a time: at rest at both ends, with a continuous acceleration.
  double way_at(std::int64_t time_ns) const {
    const double t =
        std::clamp(static_cast<double>(time_ns - start_ns_) / static_cast<double>(duration_ns_), 0.0, 1.0);
    return t * t * t * (10.0 + t * (-15.0 + 6.0 * t));
  }

  bool is_there() const {
    for (int i = 0; i < kJoints; ++i)
      if (std::abs(SensorInput(eSI_ACTUAL_ANGLE_1 + i) - to_[static_cast<std::size_t>(i)]) > tolerance_())
        return false;
    return true;
  }

  static constexpr std::size_t kWayRows = 11;
  mca::Blackboard way_{*this,
                       "Way",
                       {.content_type = "application/x-float64",
                        .row_bytes = (1 + kJoints) * sizeof(double),
                        .most_rows = kWayRows}};
  double move_ = 0.0;
  std::int64_t start_ns_ = 0, duration_ns_ = 0;
  std::array<double, kJoints> from_{}, to_{};
  mca::Parameter<double> speed_{
      *this, "Speed", 0.8, {.minimum = 0.05, .maximum = 2.0, .unit = "rad/s", .help = "highest speed"}};
  mca::Parameter<double> lead_{*this,
                               "Lead",
                               0.05,
                               {.minimum = 0.0,
                                .maximum = 1.0,
                                .unit = "s",
                                .help = "how far ahead of the curve the drives are sent"}};
  mca::Parameter<double> tolerance_{
      *this, "Tolerance", 0.005, {.minimum = 1e-4, .maximum = 0.5, .unit = "rad", .help = "to have arrived"}};
};

// The ports that the part and its group share.
struct ArmPorts {
  MCA_CONTROLLER_INPUT(eCI_TARGET_ANGLE_1, eCI_TARGET_ANGLE_2, eCI_TARGET_ANGLE_3, eCI_TARGET_ANGLE_4,
                       eCI_TARGET_ANGLE_5, eCI_TARGET_ANGLE_6, eCI_TARGET_ANGLE_7, eCI_SPEED_SHARE, eCI_MOVE,
                       eCI_DIMENSION);
  MCA_CONTROLLER_OUTPUT(eCO_DESIRED_ANGLE_1, eCO_DESIRED_ANGLE_2, eCO_DESIRED_ANGLE_3, eCO_DESIRED_ANGLE_4,
                        eCO_DESIRED_ANGLE_5, eCO_DESIRED_ANGLE_6, eCO_DESIRED_ANGLE_7, eCO_MAXIMUM_SPEED_1,
                        eCO_MAXIMUM_SPEED_2, eCO_MAXIMUM_SPEED_3, eCO_MAXIMUM_SPEED_4, eCO_MAXIMUM_SPEED_5,
                        eCO_MAXIMUM_SPEED_6, eCO_MAXIMUM_SPEED_7, eCO_DIMENSION);
  MCA_SENSOR_INPUT(eSI_ACTUAL_ANGLE_1, eSI_ACTUAL_ANGLE_2, eSI_ACTUAL_ANGLE_3, eSI_ACTUAL_ANGLE_4,
                   eSI_ACTUAL_ANGLE_5, eSI_ACTUAL_ANGLE_6, eSI_ACTUAL_ANGLE_7, eSI_PART_STATE, eSI_DIMENSION);
  MCA_SENSOR_OUTPUT(eSO_ACTUAL_ANGLE_1, eSO_ACTUAL_ANGLE_2, eSO_ACTUAL_ANGLE_3, eSO_ACTUAL_ANGLE_4,
                    eSO_ACTUAL_ANGLE_5, eSO_ACTUAL_ANGLE_6, eSO_ACTUAL_ANGLE_7, eSO_FAULT, eSO_MOVING,
                    eSO_ARRIVED, eSO_DIMENSION);
};

class Arm : public mca::Group, public ArmPorts {
 public:
  explicit Arm(mca::Place place) : Group(place, mca::ports<Arm>()) {
    auto& trajectory = add<Trajectory>("Trajectory");
    auto& supervisor = add<Supervisor>("Supervisor");
    AddEdge(controller_input(), trajectory.controller_input());
    AddEdge(trajectory.controller_output(), controller_output());
    AddEdge(sensor_input(), supervisor.sensor_input());
    AddEdge(supervisor.sensor_output(), trajectory.sensor_input());
    AddEdge(supervisor.sensor_output(), 0, sensor_output(), eSO_ACTUAL_ANGLE_1, kJoints + 1);
    AddEdge(trajectory.sensor_output(), 0, sensor_output(), eSO_MOVING, 2);
  }
};

class Motion : public mca::Part, public ArmPorts {
 public:
  explicit Motion(const std::string& name) : Part(name, mca::ports<Motion>(), 5'000'000) {
    auto& arm = add<Arm>("Arm");
    AddEdge(controller_input(), arm.controller_input());
    AddEdge(arm.controller_output(), controller_output());
    AddEdge(sensor_input(), arm.sensor_input());
    AddEdge(arm.sensor_output(), sensor_output());
  }
};

}  // namespace

int main(int argc, char** argv) {
  return mca::run<Motion>("motion", "Moves all joints of an arm together", argc, argv);
}
