// Reads the entries of `models:`: each places a robot model in the world. Throws ConfigError.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

struct RobotModel;

// Reads a model's file once, and joins its links.
RobotModel load_robot_file(Draft& draft, const config::Node& file_node);

void read_model(Draft& draft, const config::Node& node);

}  // namespace visum::scene
