// The parameters of a module (GETPARAM, SETPARAM), as m5api knows them: number, type, the firmware that first
// has it, and how it is read and written. Values agree with each other: increments, gear and floats show one
// position. A parameter that m5api knows and this model does not use can be read; writing another value is
// refused.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "hwparts/powercube/message.h"
#include "hwparts/powercube/module_state.h"

namespace visum::powercube {

enum class ValueType : std::uint8_t { kFloat, kInt32, kUint32, kInt16, kUint16, kUint8 };

// The firmware from which on m5api may ask for a parameter.
enum class Since : std::uint8_t {
  kAlways,
  kCombined,  // 0x2518 to 0x34FF, and from 0x3518 on
  kSetup,     // 0x3500
  kLoad,      // 0x351A
  kSync,      // 0x3602
  kExtended,  // 0x4601
};

struct Parameter {
  std::uint8_t id;
  ValueType type;
  Since since;
  double (*get)(const ModuleView&);
  bool (*set)(const ModuleEdit&, double);  // null: read only; false: refused
};
std::span<const Parameter> parameters();
bool known_to(Since since, std::uint16_t firmware);

// The answer to GETPARAM; nothing for one that the module does not know.
std::optional<Message> get_parameter(const ModuleView& view, std::uint8_t id);

enum class SetResult { kDone, kRefused };
// `message`: 08 id value.
SetResult set_parameter(const ModuleEdit& edit, const Message& message);

// RECALCPID: sets the drive's loop by C0, Damp and A0. Their meaning inside a real module is not published.
// Here they scale the gain of the position loop, the gain of the velocity loop and the speed of its integral
// part; the factory's values give the gains of the drive's data.
void recalculate_loop(const ModuleEdit& edit);

// The initial values of the parameters that are only kept.
std::array<double, kKept> factory_values(const drive::DriveData& data);

}  // namespace visum::powercube
