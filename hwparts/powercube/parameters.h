// The parameters of a module (GETPARAM, SETPARAM), as m5api knows them: number, type, since which firmware,
// how read and how written. Values agree with each other: increments, gear and floats are one position. What
// m5api has a number for and this model has no use for is returned, and refused where it is to change.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "hwparts/powercube/message.h"
#include "hwparts/powercube/module_state.h"

namespace visum::powercube {

enum class ValueType : std::uint8_t { kFloat, kInt32, kUint32, kInt16, kUint16, kUint8 };

// Since when m5api may ask for a parameter.
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
  bool (*set)(const ModuleEdit&, double);  // null: read only; false: not like that
};
std::span<const Parameter> parameters();
bool known_to(Since since, std::uint16_t firmware);

// The answer to GETPARAM; nothing for one that the module does not know.
std::optional<Message> get_parameter(const ModuleView& view, std::uint8_t id);

enum class SetResult { kDone, kRefused };
// `message`: 08 id value.
SetResult set_parameter(const ModuleEdit& edit, const Message& message);

// RECALCPID: the drive's loop as C0, Damp and A0 have it. What they are inside of a real module is not
// published; here they scale, from the factory's values on, the gain of the position loop, the gain of the
// velocity loop and the speed of its integral part.
void recalculate_loop(const ModuleEdit& edit);

// What parameters that are only kept start with.
std::array<double, kKept> factory_values(const drive::DriveData& data);

}  // namespace visum::powercube
