// Checks the XML of a model file before sdformat interprets it: it is well-formed, has no document types
// (entities), all numbers are finite and in range, all names exist, and the joints form a tree. tinyxml2
// stays inside these files.
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
  bool urdf = false;
  // The text for sdformat. A URDF is changed so that sdformat drops and joins nothing: fixed joints are
  // marked to be kept, links without a mass get one (see `massless`), and colours are scaled to undo
  // sdformat's own scaling.
  std::string text;
  std::vector<std::string> links, joints;  // in the order of the file; in nested SDF models as "inner::link"
  std::map<std::string, int> link_lines, joint_lines;
  std::set<std::string> massless;         // links to which the file gives no mass
  std::set<std::string> without_inertia;  // links with a mass and no inertia that a solid could have
  std::map<std::string, double>
      enlarged;  // links whose mass and inertia sdformat sees this many times larger
  std::map<std::string, std::string>
      joint_names;                           // those that sdformat sees under another name, by that name
  std::set<std::string> addresses;           // of meshes, as the file writes them
  std::map<std::string, std::string> files;  // of links and joints that come from an included file
  // By link and collision. Of SDF only.
  std::map<std::pair<std::string, std::string>, ModelSurface> surfaces;
  std::map<std::string, double> pitches;  // of screw joints, m per turn
  std::optional<ModelWorld> world;        // the file holds a <world>; its models are nested in the model
  std::vector<Remark> losses;
  std::vector<Remark> repairs;
};

inline constexpr std::size_t kMaxModelBytes = 16u << 20;

// Throws ConfigError with file, line, and the joint's or link's name; ModelErrors if there are several.
// `packages` are for what an SDF file includes.
ModelXml read_model_xml(const std::string& text, const std::string& file, const Packages& packages = {});

}  // namespace visum::scene
