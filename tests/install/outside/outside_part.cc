// A part in MCA2's manner on a page: moves the first joint of the part below by 0.1 rad.
// usage: outside_part --lower arm@HOST:PORT
#include <visum/mca/part.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace {

struct Joint {
  MCA_CONTROLLER_OUTPUT(eCO_DESIRED_ANGLE_1, eCO_DIMENSION);
  MCA_SENSOR_INPUT(eSI_ACTUAL_ANGLE_1, eSI_DIMENSION);
};

class Ramp : public visum::mca::Module, public Joint {
 public:
  explicit Ramp(visum::mca::Place place) : Module(place, visum::mca::ports<Ramp>()) {}

  void Control() override {
    const double actual = SensorInput(eSI_ACTUAL_ANGLE_1);
    if (LoopTime() == 0) start_ = ControllerOutput(eCO_DESIRED_ANGLE_1) = actual;
    const double step = speed_() * 1e-9 * static_cast<double>(Period());
    ControllerOutput(eCO_DESIRED_ANGLE_1) =
        std::min(ControllerOutput(eCO_DESIRED_ANGLE_1) + step, start_ + 0.1);
    if (std::abs(actual - start_ - 0.1) < 1e-3) EndLoop();
    if (LoopTime() > 10'000'000'000) throw std::runtime_error("the joint has not come to its angle");
  }

 private:
  visum::mca::Parameter<double> speed_{
      *this, "Speed", 0.2, {.minimum = 0.01, .maximum = 1.0, .unit = "rad/s"}};
  double start_ = 0.0;
};

class Outside : public visum::mca::Part, public Joint {
 public:
  explicit Outside(const std::string& name) : Part(name, visum::mca::ports<Outside>(), 10'000'000) {
    auto& ramp = add<Ramp>("Ramp");
    AddEdge(sensor_input(), ramp.sensor_input());
    AddEdge(ramp.controller_output(), controller_output());
  }
};

}  // namespace

int main(int argc, char** argv) {
  return visum::mca::run<Outside>("outside", "Moves a joint", argc, argv);
}
