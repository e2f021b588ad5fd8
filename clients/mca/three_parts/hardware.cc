// visum-mca-hardware: the lowest of the three parts. It stands between the controller and an arm, virtual or
// real, and lets no desired angle run away from the arm.
#include <algorithm>

#include "clients/mca/part.h"

namespace {

using namespace visum;

constexpr int kJoints = 7;

// The ports of the arm, which the part and its module share.
struct ArmPorts {
  MCA_CONTROLLER_INPUT(eCI_DESIRED_ANGLE_1, eCI_DESIRED_ANGLE_2, eCI_DESIRED_ANGLE_3, eCI_DESIRED_ANGLE_4,
                       eCI_DESIRED_ANGLE_5, eCI_DESIRED_ANGLE_6, eCI_DESIRED_ANGLE_7, eCI_MAXIMUM_SPEED_1,
                       eCI_MAXIMUM_SPEED_2, eCI_MAXIMUM_SPEED_3, eCI_MAXIMUM_SPEED_4, eCI_MAXIMUM_SPEED_5,
                       eCI_MAXIMUM_SPEED_6, eCI_MAXIMUM_SPEED_7, eCI_DIMENSION);
  MCA_CONTROLLER_OUTPUT(eCO_DESIRED_ANGLE_1, eCO_DESIRED_ANGLE_2, eCO_DESIRED_ANGLE_3, eCO_DESIRED_ANGLE_4,
                        eCO_DESIRED_ANGLE_5, eCO_DESIRED_ANGLE_6, eCO_DESIRED_ANGLE_7, eCO_MAXIMUM_SPEED_1,
                        eCO_MAXIMUM_SPEED_2, eCO_MAXIMUM_SPEED_3, eCO_MAXIMUM_SPEED_4, eCO_MAXIMUM_SPEED_5,
                        eCO_MAXIMUM_SPEED_6, eCO_MAXIMUM_SPEED_7, eCO_DIMENSION);
  MCA_SENSOR_INPUT(eSI_ACTUAL_ANGLE_1, eSI_ACTUAL_ANGLE_2, eSI_ACTUAL_ANGLE_3, eSI_ACTUAL_ANGLE_4,
                   eSI_ACTUAL_ANGLE_5, eSI_ACTUAL_ANGLE_6, eSI_ACTUAL_ANGLE_7, eSI_PART_STATE, eSI_DIMENSION);
  MCA_SENSOR_OUTPUT(eSO_ACTUAL_ANGLE_1, eSO_ACTUAL_ANGLE_2, eSO_ACTUAL_ANGLE_3, eSO_ACTUAL_ANGLE_4,
                    eSO_ACTUAL_ANGLE_5, eSO_ACTUAL_ANGLE_6, eSO_ACTUAL_ANGLE_7, eSO_PART_STATE,
                    eSO_DIMENSION);
};

// Keeps each desired angle near the actual one. So a controller that goes on while the arm is held moves
// nothing far once it is let go.
class Guard : public mca::Module, public ArmPorts {
 public:
  explicit Guard(mca::Place place) : Module(place, mca::ports<Guard>()) {}

  void Sense() override {
    for (int i = 0; i < eSO_DIMENSION; ++i) SensorOutput(i) = SensorInput(i);
  }

  void Control() override {
    commanded_ = commanded_ || ControllerInput(eCI_MAXIMUM_SPEED_1) > 0.0;
    if (!commanded_) return hold();
    for (int i = 0; i < kJoints; ++i) {
      const double actual = SensorInput(eSI_ACTUAL_ANGLE_1 + i);
      ControllerOutput(eCO_DESIRED_ANGLE_1 + i) =
          std::clamp(ControllerInput(eCI_DESIRED_ANGLE_1 + i), actual - lead_(), actual + lead_());
      ControllerOutput(eCO_MAXIMUM_SPEED_1 + i) = ControllerInput(eCI_MAXIMUM_SPEED_1 + i);
    }
  }

 private:
  // Nobody above has commanded anything yet: the arm stands where it was found.
  void hold() {
    if (holds_) return;
    holds_ = true;
    for (int i = 0; i < kJoints; ++i) {
      ControllerOutput(eCO_DESIRED_ANGLE_1 + i) = SensorInput(eSI_ACTUAL_ANGLE_1 + i);
      ControllerOutput(eCO_MAXIMUM_SPEED_1 + i) = 0.1;
    }
  }

  bool commanded_ = false, holds_ = false;
  mca::Parameter<double> lead_{*this,
                               "Largest Lead",
                               0.5,
                               {.minimum = 0.01,
                                .maximum = 10.0,
                                .unit = "rad",
                                .help = "how far a desired angle may be from the actual one"}};
};

class Hardware : public mca::Part, public ArmPorts {
 public:
  explicit Hardware(const std::string& name) : Part(name, mca::ports<Hardware>(), 5'000'000) {
    auto& guard = add<Guard>("Guard");
    AddEdge(controller_input(), guard.controller_input());
    AddEdge(guard.controller_output(), controller_output());
    AddEdge(sensor_input(), guard.sensor_input());
    AddEdge(guard.sensor_output(), sensor_output());
  }
};

}  // namespace

int main(int argc, char** argv) {
  return mca::run<Hardware>("hardware", "Stands between a controller and an arm, virtual or real", argc,
                            argv);
}
