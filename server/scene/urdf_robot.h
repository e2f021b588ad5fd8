// Reads a URDF into a RobotModel. Inner header: it includes tinyxml2.
// Source: https://wiki.ros.org/urdf/XML
#pragma once

#include <tinyxml2.h>

#include <filesystem>

#include "server/scene/packages.h"
#include "server/scene/robot_model.h"

namespace visum::scene {

// Repairs, checks and reads the document. Throws ConfigError; ModelErrors if there are several.
RobotModel read_urdf_robot(tinyxml2::XMLDocument& document, const std::filesystem::path& file,
                           const Packages& packages);

}  // namespace visum::scene
