// Where the packages lie that a model's mesh addresses name.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace visum::scene {

struct Packages {
  std::map<std::string, std::filesystem::path> given;  // --package NAME=PATH
  std::vector<std::filesystem::path> folders;          // each holds packages as folders of their name
};

// Adds the folders that ROS_PACKAGE_PATH, AMENT_PREFIX_PATH, GZ_SIM_RESOURCE_PATH, GAZEBO_MODEL_PATH and
// SDF_PATH name.
Packages with_environment(Packages packages);

// Finds "robot/meshes/arm.stl", where "robot" is a package: by its given path, in the folders above the model
// (as a folder of that name, or one whose package.xml says so), then in `packages.folders`. Slashes in front,
// as of "package:///robot/meshes/arm.stl", do not count. Empty if there is no such file.
std::filesystem::path find_in_package(const std::string& name_and_rest,
                                      const std::filesystem::path& model_file, const Packages& packages);

// The same for what `accept` makes of each place: it returns the file that it takes, or an empty path.
using AcceptPath = std::function<std::filesystem::path(const std::filesystem::path&)>;
std::filesystem::path find_in_package(const std::string& name_and_rest,
                                      const std::filesystem::path& model_file, const Packages& packages,
                                      const AcceptPath& accept);

}  // namespace visum::scene
