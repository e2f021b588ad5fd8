// Kind `amtec_arm`: the 7-DOF PowerCube arm with its two-finger gripper, 8 modules on 9 joints. The layout of
// its ports, in MCA2's manner, is defined here and nowhere else; it serves the virtual and the real arm.
// Behaviour: servo_group.h.
#pragma once

#include <memory>

#include "hwparts/part.h"

namespace visum::amtec_arm {

// The drives file must hold, in this order, 7 rotary drives of one joint each and one linear drive of two
// joints. Throws ConfigError.
std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context);

// The same in front of real modules. Throws std::runtime_error where the bus is not this arm's.
std::unique_ptr<hwparts::Part> make_real(const hwparts::PartContext& context, powercube::BusConnection& line,
                                         const hwparts::RealOptions& options);

}  // namespace visum::amtec_arm
