// Takes the shapes of a model's links in: finds and reads their meshes, gives them looks, and says which are
// not shown. The readers of URDF and SDF share it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "server/scene/packages.h"
#include "server/scene/robot_model.h"

namespace visum::scene {

// As a model names a mesh, and the file in which it does.
struct MeshAddress {
  std::string address, model_file;
};

class ShapeIntake {
 public:
  ShapeIntake(RobotModel& model, const Packages& packages) : model_(model), packages_(packages) {}

  // Converts the Collada files among these at once; find_mesh() then has them. It also converts others, one
  // at a time, and reports what is wrong with each.
  void convert_ahead(const std::vector<MeshAddress>& meshes);

  // Finds the mesh that `address` names in the file of `link`, and fills kind and mesh. Returns the reason if
  // it cannot. Throws ConfigError if the shape collides and the file is not there.
  std::string find_mesh(const std::string& address, const RobotLink& link, RobotShape& shape);

  // Adds the shape to `link`: one for each material of a Collada file, which the shape's own colour replaces.
  // `fault` says why it cannot be had: a visual is left out then. Throws ConfigError for one that collides.
  void add(RobotShape shape, const std::string& fault, double opacity, RobotLink& link);

  // Reports the shape as a loss.
  void leave_out(const RobotShape& shape, const std::string& fault, const RobotLink& link);

 private:
  config::Place place_of(const RobotLink& link) const;
  void add_parts(const RobotShape& whole, double opacity, RobotLink& link);
  std::string check_seen_mesh(const RobotShape& shape, const RobotLink& link);
  std::string convert(const std::filesystem::path& file);
  // Keeps a converted mesh, or why there is none, which it returns.
  std::string take(const std::filesystem::path& file, const std::function<ColladaMesh()>& mesh);

  RobotModel& model_;
  const Packages& packages_;
  std::map<std::filesystem::path, std::string> seen_meshes_;    // with what is wrong with them
  std::map<std::filesystem::path, std::string> not_converted_;  // with the reasons
};

}  // namespace visum::scene
