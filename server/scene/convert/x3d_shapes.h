// The shapes of an X3D scene: finds nodes by name, follows transforms, and adds shapes to bodies of the
// draft.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/scene/convert/x3d_geometry.h"
#include "server/scene/convert/x3d_node.h"
#include "server/scene/draft.h"

namespace visum::scene {

// The frame N of a node, seen from a body (or from W): a point p of N is X * (stretch * p).
struct X3dFrame {
  world::Pose X;
  Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return X * (stretch * point); }
};

// Null if the node has no such child.
const X3dNode* x3d_child(const X3dNode& node, const std::string& field);

// The metadata's pose if it agrees with the fields; otherwise the fields'.
world::Pose x3d_exact_pose(const std::optional<config::Node>& metadata, const world::Pose& fields);

// The draft, the tree and the file's name must outlive it.
class X3dShapes {
 public:
  X3dShapes(Draft& draft, const X3dNode& root, const std::string& file);

  const std::string& file() const { return file_; }
  config::Place place_of(const X3dNode& node) const;
  [[noreturn]] void fail(const X3dNode& node, const std::string& message) const;
  // Notes a loss at the node, with its file and line.
  void lose(const X3dNode& node, const std::string& sentence) const;

  // Follows USE. Fails if there is no node of that name.
  const X3dNode& resolved(const X3dNode& node) const;
  // The YAML in the metadata node beside a node's fields.
  std::optional<config::Node> metadata(const X3dNode& node) const;
  std::string name_of(const X3dNode& node, const std::optional<config::Node>& metadata, const char* what,
                      std::size_t number) const;

  Eigen::Vector3d vector(const X3dNode& node, const std::string& field,
                         const Eigen::Vector3d& otherwise) const;
  Eigen::Quaterniond rotation(const X3dNode& node, const std::string& field) const;
  // The frame inside of a Transform that stands in the frame `outer`.
  X3dFrame inside(const X3dNode& transform, const X3dFrame& outer) const;

  // The children of a group that are seen: of LOD the nearest, of Switch the chosen one.
  std::vector<const X3dNode*> shown(const X3dNode& node) const;

  // The shape that a Shape node stands for, in the frame of its body; `number` makes its name if it has none.
  // Returns nothing, and notes a loss, for geometry that is not read or has no faces.
  std::optional<world::Shape> shape_of(const X3dNode& node, const X3dFrame& frame, std::size_t number,
                                       const std::optional<config::Node>& known = {});
  // Adds it to a body.
  void add(const X3dNode& node, world::BodyId body, const X3dFrame& frame, bool collides,
           const std::optional<config::Node>& known);

 private:
  void index(const X3dNode& node);
  const std::optional<X3dForm>& form_of(const X3dNode& node, const Eigen::Matrix3d& stretch);
  void read_color(const X3dNode& node, world::Shape& shape) const;

  Draft& draft_;
  const std::string& file_;
  std::map<std::string, const X3dNode*> defs_;
  std::vector<const X3dNode*> scripts_;
  std::map<std::pair<const X3dNode*, std::array<double, 9>>, std::optional<X3dForm>> forms_;
  std::size_t vertices_ = 0;
};

}  // namespace visum::scene
