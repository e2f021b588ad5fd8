// Everything that the readers of one MJCF file share. It lives while the file is read.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/scene/mjcf/settings.h"
#include "server/scene/robot_model.h"

namespace visum::scene::mjcf {

// Remarks of one kind become one sentence: "armature is not simulated: joint 'a' and 3 others".
class Remarks {
 public:
  void add(const std::string& sentence, const Element& about);
  // In the order in which the kinds came. `file`: the model's own.
  std::vector<Remark> all(const std::filesystem::path& file) const;

 private:
  struct Kind {
    std::string sentence;
    const Element* first;
    std::size_t count;
  };
  std::vector<Kind> kinds_;
};

// The meshes and materials of <asset>. A mesh is read when the first geom needs it.
class Assets {
 public:
  Assets(const Element& root, const Defaults& defaults, const Settings& settings,
         const std::filesystem::path& model_file, const Packages& packages);

  // Scaled and placed as the asset says. Throws ConfigError at the asset, or at `user` if there is none.
  const world::TriangleMesh& mesh(const std::string& name, const Element& user);
  // Nothing if the material has no colour of its own. Throws ConfigError at `user`.
  std::optional<std::array<double, 4>> color(const std::string& material, const Element& user) const;

 private:
  world::TriangleMesh read(const Element& element) const;
  world::TriangleMesh read_file(const Element& element, const std::string& address) const;

  const Defaults& defaults_;
  const Settings& settings_;
  const std::filesystem::path model_file_;
  const Packages& packages_;
  std::map<std::string, const Element*> meshes_, materials_;
  std::map<std::string, world::TriangleMesh> read_;
  std::size_t triangles_ = 0;
};

struct Reading {
  Reading(const Element& document, RobotModel& robot, const Packages& packages)
      : root(document),
        settings(read_settings(root)),
        defaults(root),
        assets(root, defaults, settings, robot.file, packages),
        model(robot) {}

  const Element& root;
  const Settings settings;
  const Defaults defaults;
  Assets assets;
  RobotModel& model;
  Remarks losses, repairs;
  std::vector<config::ConfigError> errors;  // each about another element
};

inline constexpr std::size_t kMaxErrors = 100;

}  // namespace visum::scene::mjcf
