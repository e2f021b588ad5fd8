// One PowerCube module: a drive on a field bus. It answers at once, from what the drive knew at the last
// tick. A command is in force, and shows in the state word, before its answer leaves. These functions run on
// the tick's thread, between ticks, and do not allocate. Nothing fails: a wrong message is refused or not
// answered, as a real module does it.
#pragma once

#include <optional>

#include "hwparts/powercube/message.h"
#include "hwparts/powercube/module_state.h"

namespace visum::powercube {

enum class BusFraming { kSerial, kCan };

// Carries out a message for this module. Returns the answer; nothing where a real module would be silent.
std::optional<Message> execute(const ModuleEdit& edit, const Message& message, BusFraming framing);
// Carries out a message for all modules. These are never answered.
void execute_broadcast(const ModuleEdit& edit, const Message& message, BusFraming framing);
// Once per tick, before the drive's act(): runs the watchdog, and opens the loop of a halted module whose
// configuration says so.
void tick(const ModuleEdit& edit, double tick_s);
// The state frame that the module sends now unasked, if its configuration has SYNC_TRANSMIT.
std::optional<Message> spontaneous_state(const ModuleEdit& edit, double tick_s);

}  // namespace visum::powercube
