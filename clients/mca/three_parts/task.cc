// visum-mca-task: the uppermost of the three parts. It sends the arm through a few poses and back, and ends.
#include <array>

#include "clients/mca/part.h"

namespace {

using namespace visum;

constexpr int kJoints = 7;

// The ports that the part and its module share.
struct ArmPorts {
  MCA_CONTROLLER_OUTPUT(eCO_TARGET_ANGLE_1, eCO_TARGET_ANGLE_2, eCO_TARGET_ANGLE_3, eCO_TARGET_ANGLE_4,
                        eCO_TARGET_ANGLE_5, eCO_TARGET_ANGLE_6, eCO_TARGET_ANGLE_7, eCO_SPEED_SHARE, eCO_MOVE,
                        eCO_DIMENSION);
  MCA_SENSOR_INPUT(eSI_ACTUAL_ANGLE_1, eSI_ACTUAL_ANGLE_2, eSI_ACTUAL_ANGLE_3, eSI_ACTUAL_ANGLE_4,
                   eSI_ACTUAL_ANGLE_5, eSI_ACTUAL_ANGLE_6, eSI_ACTUAL_ANGLE_7, eSI_FAULT, eSI_MOVING,
                   eSI_ARRIVED, eSI_DIMENSION);
};

// Goes from pose to pose. A pose is a way from where the arm was found.
class Sequence : public mca::Module, public ArmPorts {
 public:
  explicit Sequence(mca::Place place) : Module(place, mca::ports<Sequence>()) {}

  void Sense() override {
    if (SensorInput(eSI_FAULT) > 0.0) EndLoop();  // nothing more can be done from here
  }

  void Control() override {
    if (next_ == 0 && arrived_ns_ < 0) begin();
    const bool arrived = SensorInput(eSI_ARRIVED) == ControllerOutput(eCO_MOVE);
    if (!arrived) {
      arrived_ns_ = -1;
      return;
    }
    if (arrived_ns_ < 0) arrived_ns_ = LoopTime();
    const auto pause_ns = static_cast<std::int64_t>(pause_() * 1e9);
    if (LoopTime() - arrived_ns_ < pause_ns) return;
    if (next_ == kPoses.size()) return EndLoop();
    for (int i = 0; i < kJoints; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      ControllerOutput(eCO_TARGET_ANGLE_1 + i) = start_[joint] + kPoses[next_][joint];
    }
    ControllerOutput(eCO_SPEED_SHARE) = share_();
    ControllerOutput(eCO_MOVE) += 1.0;
    ++next_;
    Debug(1, "task", "goes to pose " + std::to_string(next_));
  }

 private:
  static constexpr std::array<std::array<double, kJoints>, 3> kPoses{{
      {0.6, 0.2, 0.0, -0.3, 0.0, 0.2, 0.4},
      {-0.6, 0.1, 0.2, -0.2, 0.3, 0.0, -0.4},
      {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
  }};

  // The arm is to stay where it is, and the counting of moves goes on from the last one.
  void begin() {
    ControllerOutput(eCO_MOVE) = SensorInput(eSI_ARRIVED);
    for (int i = 0; i < kJoints; ++i)
      start_[static_cast<std::size_t>(i)] = ControllerOutput(eCO_TARGET_ANGLE_1 + i) =
          SensorInput(eSI_ACTUAL_ANGLE_1 + i);
  }

  std::size_t next_ = 0;
  std::int64_t arrived_ns_ = -1;
  std::array<double, kJoints> start_{};
  mca::Parameter<double> pause_{
      *this, "Pause", 0.2, {.minimum = 0.0, .maximum = 60.0, .unit = "s", .help = "at each pose"}};
  mca::Parameter<double> share_{
      *this, "Speed Share", 1.0, {.minimum = 0.05, .maximum = 1.0, .help = "of the highest speed"}};
};

class Task : public mca::Part, public ArmPorts {
 public:
  explicit Task(const std::string& name) : Part(name, mca::ports<Task>(), 10'000'000) {
    auto& sequence = add<Sequence>("Sequence");
    AddEdge(sequence.controller_output(), controller_output());
    AddEdge(sensor_input(), sequence.sensor_input());
  }
};

}  // namespace

int main(int argc, char** argv) {
  return mca::run<Task>("task", "Sends an arm through a few poses and back", argc, argv);
}
