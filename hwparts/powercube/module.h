// One PowerCube module: a drive with a wire. Answers at once, from what the drive knows as of the last tick;
// what a command changes is in force, and in the state word, before the answer is out. Lives on the tick's
// thread. No allocation.
#pragma once

#include <optional>

#include "hwparts/powercube/message.h"
#include "hwparts/powercube/module_state.h"

namespace visum::powercube {

enum class BusFraming { kSerial, kCan };

// The answer to a message for this module; nothing where a real one would be silent.
std::optional<Message> execute(const ModuleEdit& edit, const Message& message, BusFraming framing);
// A message for everybody; never answered.
void execute_broadcast(const ModuleEdit& edit, const Message& message, BusFraming framing);
// Once per tick, after the drive's: watchdog, what a halt does to the power stage.
void tick(const ModuleEdit& edit, double tick_s);
// The state frame, where SYNC_TRANSMIT wants one now.
std::optional<Message> spontaneous_state(const ModuleEdit& edit, double tick_s);

}  // namespace visum::powercube
