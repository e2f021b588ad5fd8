// Turns X3D's geometry nodes into our shapes.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "server/scene/convert/x3d_node.h"
#include "server/world/world_model.h"

namespace visum::scene {

struct X3dForm {
  world::ShapeKind kind = world::ShapeKind::kBox;  // box, sphere, cylinder or mesh
  std::array<double, 3> size{};
  Eigen::Quaterniond q_NS = Eigen::Quaterniond::Identity();  // from the shape's frame to the node's
  world::TriangleMesh mesh;
};

// Returns nothing for geometry that is not read. Throws ConfigError for wrong geometry. `scale` is the same
// along all axes.
std::optional<X3dForm> read_x3d_geometry(const X3dNode& node, const Eigen::Vector3d& scale,
                                         const std::string& file,
                                         const std::function<const X3dNode&(const X3dNode&)>& resolved);

}  // namespace visum::scene
