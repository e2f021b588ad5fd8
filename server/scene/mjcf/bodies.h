// Reads <worldbody>: the tree of bodies with their joints and geoms, as the file gives it.
#pragma once

#include "server/scene/mjcf/geoms.h"

namespace visum::scene::mjcf {

enum class JointType { kHinge, kSlide, kBall };

struct JointEntry {
  const Element* element;
  std::string name;  // made up where the file gives none
  std::string class_name;
  JointType type = JointType::kHinge;
  Eigen::Vector3d anchor_B = Eigen::Vector3d::Zero(), axis_B = Eigen::Vector3d::UnitZ();
  double reference = 0.0;  // its position in the pose of the file, rad or m
  double initial = 0.0;    // position at the start
  Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();  // of a ball at the start
};

struct BodyEntry {
  const Element* element;
  std::string name;  // made up where the file gives none
  std::size_t parent = 0;
  world::Pose X_PB;                 // as in the file
  bool free = false;                // nothing holds it
  std::optional<world::Pose> X_WB;  // of a free body: where it starts, if not there
  bool mocap = false;
  std::vector<JointEntry> joints;  // the first one stands at the parent
  std::vector<Geom> geoms;
  MassProperties mass;    // in the body's frame
  bool moves = false;     // it, or a body that it is fixed to, has a joint
  std::size_t group = 0;  // the body that it is one rigid thing with; itself where it has a joint
};

// The bodies with each behind its parent, in MuJoCo's order; the first is the world. Errors and losses go to
// `reading`.
std::vector<BodyEntry> read_bodies(Reading& reading);

// The index of the body of this name, or 0 for "world". Throws ConfigError at `user`.
std::size_t find_body(const std::vector<BodyEntry>& bodies, const std::string& name, const Element& user);

inline constexpr std::size_t kMaxBodies = 2000;
inline constexpr const char* kWorldGeoms = "worldbody";  // the link of the world's own geoms

}  // namespace visum::scene::mjcf
