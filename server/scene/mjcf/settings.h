// <compiler> and <option> of an MJCF file, and the places of things, which <compiler> says how to read.
#pragma once

#include <optional>
#include <string>

#include "server/scene/mjcf/values.h"
#include "server/world/world_model.h"

namespace visum::scene::mjcf {

struct Settings {
  double radians_per_angle = 0.017453292519943295;  // the file's angles are degrees unless it says otherwise
  std::string euler_sequence = "xyz";
  std::string mesh_folder;
  bool strip_path = false;
  bool auto_limits = true;
  bool balance_inertia = false;
  bool exact_mesh_inertia = false;
  std::optional<bool> inertia_from_geoms;  // none: where there is no <inertial>
  double least_mass = 0.0, least_inertia = 0.0;
  double total_mass = 0.0;  // > 0: all masses are scaled to this sum
  int least_mass_group = 0, most_mass_group = 5;
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};
  bool only_pairs_collide = false;
};

// Throws ConfigError.
Settings read_settings(const Element& root);

// The turn that an element gives by quat, axisangle, euler, xyaxes or zaxis; none if it gives none of them.
std::optional<Eigen::Quaterniond> read_turn(const Values& values, const Settings& settings);
world::Pose read_pose(const Values& values, const Settings& settings);

// The least turn that brings z to `direction`, which need not have length 1.
Eigen::Quaterniond turn_of_z(const Eigen::Vector3d& direction);
Eigen::Quaterniond turn_about(const Eigen::Vector3d& unit_axis, double radians);

}  // namespace visum::scene::mjcf
