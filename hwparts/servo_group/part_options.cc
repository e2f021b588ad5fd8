#include "hwparts/servo_group/part_options.h"

namespace visum::servo_group {

PartOptions read_options(const config::Node& entry) {
  entry.allow_only({"name", "kind", "model", "joints", "drives", "on_controller_lost", "homed",
                    "execution_enable", "modules", "bus"});
  PartOptions options;
  if (const auto lost = entry.find("on_controller_lost")) {
    options.on_controller_lost =
        lost->one_of({"stop", "hold"}) == "hold" ? OnControllerLost::kHold : OnControllerLost::kStop;
  }
  options.homed = entry.boolean_or("homed", true);
  if (const auto enable = entry.find("execution_enable")) options.execution_enable = enable->boolean();
  return options;
}

}  // namespace visum::servo_group
