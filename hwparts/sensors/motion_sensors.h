// Sensors for motion, contact and load: the kinds `imu`, `pose`, `contact` and `joint_wrench`. "Truth" below
// is what a kind needs to be told by the world.
#pragma once

#include <memory>

#include "hwparts/sensors/sensor.h"

namespace visum::sensors {

// Truth: angular velocity (rad/s) and specific force (m/s²: acceleration minus gravity), both in the sensor's
// frame, x y z each. At rest and level it reads +9.81 along z.
std::unique_ptr<Sensor> make_imu(const SensorContext& context);

// Truth: place (m) and orientation (unit quaternion w x y z) of the sensor's frame in the world.
std::unique_ptr<Sensor> make_pose(const SensorContext& context);

// Truth: the sum of the normal forces on the body, N.
std::unique_ptr<Sensor> make_contact(const SensorContext& context);

// Truth: force (N) and torque (N·m, about the joint's origin) that the parent puts on the child through the
// joint, in the joint's frame on the child's side, x y z each.
std::unique_ptr<Sensor> make_joint_wrench(const SensorContext& context);

}  // namespace visum::sensors
