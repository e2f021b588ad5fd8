// The kind `amtec_arm`: the 7-DOF PowerCube arm with its two-finger gripper, 8 modules on 9 joints. Only this
// folder defines the layout of its ports, which follows MCA2 and serves the virtual and the real arm.
// servo_group.h describes the behaviour.
#pragma once

#include <memory>

#include "hwparts/part.h"

namespace visum::amtec_arm {

// Makes the virtual arm. The drives file must hold, in this order, 7 rotary drives of one joint each and one
// linear drive of two joints. Throws ConfigError.
std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context);

// The same part in front of real modules. Throws std::runtime_error where the modules on the bus are not this
// arm's.
std::unique_ptr<hwparts::Part> make_real(const hwparts::PartContext& context, powercube::BusConnection& line,
                                         const hwparts::RealOptions& options);

}  // namespace visum::amtec_arm
