// Reads an SDF model after read_sdf() has checked it. Inner header, as xml_checks.h.
#pragma once

#include <filesystem>

#include "server/scene/packages.h"
#include "server/scene/robot_model.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {

// Throws ConfigError, or ModelErrors if there are several.
RobotModel read_sdf_robot(tinyxml2::XMLDocument& document, const std::filesystem::path& file,
                          const Packages& packages);

}  // namespace visum::scene
