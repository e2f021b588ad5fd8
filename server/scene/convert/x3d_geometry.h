// Turns X3D's geometry nodes into our shapes.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "server/scene/convert/x3d_node.h"
#include "server/world/world_model.h"

namespace visum::scene {

bool is_x3d_mesh(const std::string& type);  // the types of nodes with faces

struct X3dForm {
  world::ShapeKind kind = world::ShapeKind::kBox;  // box, sphere, cylinder, convex or mesh
  std::array<double, 3> size{};
  Eigen::Quaterniond q_NS = Eigen::Quaterniond::Identity();  // from the shape's frame to the node's
  world::TriangleMesh mesh;
};

// Returns nothing for geometry that is not read or has no faces. Throws ConfigError for wrong geometry.
// `stretch` scales it. What is then no box, sphere or cylinder any more becomes the convex hull of its
// points.
std::optional<X3dForm> read_x3d_geometry(const X3dNode& node, const Eigen::Matrix3d& stretch,
                                         const std::string& file,
                                         const std::function<const X3dNode&(const X3dNode&)>& resolved);

}  // namespace visum::scene
