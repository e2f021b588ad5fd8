// The arm's part for real modules, in closed loop with virtual modules behind it, over a connection that the
// test can cut. Ticked by hand.
#pragma once

#include <memory>
#include <string>

#include "hwparts/kinds/part_kinds.h"
#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/plugged_connection.h"
#include "tests/hwparts/rig.h"

namespace visum::test {

// Further keys, to be appended to those that arm_context() writes.
inline std::string further(const std::string& keys) {
  return keys.empty() ? "" : ", " + keys;
}

class RealBench {
 public:
  // `behind`: further keys of the part behind the bus; `front`: of the part in front of it.
  explicit RealBench(powercube::BusFraming framing = powercube::BusFraming::kSerial,
                     const std::string& behind = "", const std::string& front = "",
                     const hwparts::RealOptions& options = {true})
      : behind("amtec_arm", arm_context(0.001, 0.1, 0.017, further(behind))),
        line(
            *this->behind.part, framing, [this] { tick_behind(); }, 0.001),
        part(hwparts::make_real_part("amtec_arm", arm_context(0.001, 0.0, 0.0, further(front)), line,
                                     options)) {
    for (const auto& port : part->description().controller_inputs) inputs.push_back(port.initial);
    for (const auto& port : part->description().sensor_outputs) outputs.push_back(port.initial);
  }

  void tick() {
    part->act(inputs, {}, {});
    part->publish({}, outputs);
    for (int i = 0; i < kExchanges; ++i) part->pump();
    tick_behind();
  }
  void run(double seconds) {
    for (double t = 0.0; t < seconds; t += 0.001) tick();
  }

  PartBench behind;
  PluggedConnection line;
  std::unique_ptr<hwparts::Part> part;
  std::vector<double> inputs, outputs;

 private:
  static constexpr int kExchanges = 12;  // an ideal line has time for more in a tick
  void tick_behind() {
    behind.tick();
    line.pass_tick();
  }
};

}  // namespace visum::test
