// The findings of the checks of a model's XML, before it is read: it is well-formed, has no document types
// (entities), all numbers are finite and in range, all names exist, and the joints form a tree.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "protocol/config/config.h"
#include "server/scene/packages.h"
#include "server/scene/remark.h"

namespace visum::scene {

// How the surface of a collision behaves, as far as the file says it.
struct ModelSurface {
  std::optional<double> friction, restitution, torsional_friction;
  bool collides = true;

  bool says_anything() const { return friction || restitution || torsional_friction; }
};

// The settings of a <world>, beside its models.
struct ModelWorld {
  std::optional<Eigen::Vector3d> gravity;
  std::optional<double> step_s;
  std::vector<std::string> left_out;  // includes that were not found, and why
};

struct ModelXml {
  std::vector<std::string> links, joints;  // in the order of the file; in nested SDF models as "inner::link"
  std::map<std::string, int> link_lines, joint_lines;
  std::set<std::string> massless;            // links to which the file gives no mass
  std::set<std::string> without_inertia;     // links with a mass and no inertia that a solid could have
  std::map<std::string, std::string> files;  // of links and joints that come from an included file
  // By link and collision. Of SDF only.
  std::map<std::pair<std::string, std::string>, ModelSurface> surfaces;
  std::map<std::string, double> pitches;  // of screw joints, m per turn
  std::optional<ModelWorld> world;        // the file holds a <world>; its models are nested in the model
  std::vector<Remark> losses;
  std::vector<Remark> repairs;
};

inline constexpr std::size_t kMaxModelBytes = 16u << 20;

}  // namespace visum::scene
