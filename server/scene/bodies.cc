#include "server/scene/bodies.h"

#include "server/scene/frames.h"
#include "server/scene/shapes.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;

constexpr std::size_t kMaxShapes = 1000;  // of one body

std::vector<world::Shape> read_shapes(Draft& draft, const Node& body) {
  std::vector<world::Shape> shapes;
  const auto list = body.find("shapes");
  if (!list) return shapes;
  const ShapeDefaults defaults = read_defaults(draft, body, {});
  if (list->size() > kMaxShapes) list->fail("more than " + std::to_string(kMaxShapes) + " shapes");
  for (std::size_t i = 0; i < list->size(); ++i)
    shapes.push_back(read_shape(draft, list->at(i), i, defaults));
  return shapes;
}

// All shapes together, with density 1. Overlapping shapes count twice.
MassProperties solid_of_shapes(const Draft& draft, const Node& body,
                               const std::vector<world::Shape>& shapes) {
  MassProperties solid;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Node entry = body.get("shapes").at(i);
    if (shapes[i].kind == world::ShapeKind::kPlane) entry.fail("a plane is for bodies with 'fixed: true'");
    if (shapes[i].collides) solid = together(solid, solid_in_body(draft, shapes[i], entry));
  }
  if (solid.mass_kg <= 0)
    body.fail("has no shape that collides to compute its inertia from: give 'mass' and 'inertia'");
  return solid;
}

Eigen::Matrix3d read_inertia(const Node& node) {
  const std::vector<double> i = node.numbers(6, kPlaceable);  // ixx iyy izz ixy ixz iyz
  Eigen::Matrix3d inertia;
  inertia << i[0], i[3], i[4],  //
      i[3], i[1], i[5],         //
      i[4], i[5], i[2];
  return inertia;
}

// Mass and inertia as given, or computed from the shapes and a mass or density.
MassProperties read_mass(const Draft& draft, const Node& body, const std::vector<world::Shape>& shapes) {
  const auto mass = body.find("mass"), density = body.find("density"), inertia = body.find("inertia");
  if (mass && density) body.fail("has both 'mass' and 'density', one is enough");
  if (!mass && !density) body.fail("needs 'mass', 'density', 'fixed: true' or 'kinematic: true'");
  if (inertia) {
    if (!mass) inertia->fail("needs 'mass' beside it");
    const auto com = body.find("com");
    return {mass->number(config::kPositive), com ? read_vector(*com) : Eigen::Vector3d::Zero(),
            read_inertia(*inertia)};
  }
  if (const auto com = body.find("com"))
    com->fail("needs 'inertia' beside it (without, both come from the shapes)");
  const double factor = density ? density->number(config::kPositive) : 0.0;
  const double mass_kg = mass ? mass->number(config::kPositive) : 0.0;
  const MassProperties solid = solid_of_shapes(draft, body, shapes);
  return scaled(solid, density ? factor : mass_kg / solid.mass_kg);
}

void refuse_keys(const Node& body, std::initializer_list<const char*> keys, const std::string& why) {
  for (const char* key : keys)
    if (const auto node = body.find(key)) node->fail(why);
}

void read_motion(const Draft& draft, const Node& node, const std::vector<world::Shape>& shapes,
                 world::Body& body) {
  if (body.fixed)
    return refuse_keys(node, {"mass", "density", "inertia", "com", "velocity", "engine"},
                       "means nothing for a body with 'fixed: true'");
  if (body.kinematic) {
    refuse_keys(node, {"mass", "density", "inertia", "com", "engine"},
                "means nothing for a body with 'kinematic: true', which moves as it is told");
    body.engine = world::kNoEngine;
  } else {
    const MassProperties mass = read_mass(draft, node, shapes);
    body.mass_kg = mass.mass_kg;
    body.p_BC = mass.com;
    body.inertia_C = mass.inertia_C;
    if (const auto engine = node.find("engine")) body.engine = draft.engine(*engine);
  }
  const auto velocity = node.find("velocity");
  if (!velocity) return;
  velocity->allow_only({"linear", "angular"});
  if (const auto linear = velocity->find("linear"))
    body.v_WB = direction_in_world(draft, read_vector(*linear));
  if (const auto angular = velocity->find("angular"))
    body.w_WB = direction_in_world(draft, read_vector(*angular));
}

}  // namespace

void read_body(Draft& draft, const Node& node) {
  node.allow_only({"name", "fixed", "kinematic", "mass", "density", "inertia", "com", "pose", "velocity",
                   "shapes", "engine", "surface", "color", "material"});
  world::Body body;
  body.name = read_name(node.get("name"));
  body.fixed = node.boolean_or("fixed", false);
  body.kinematic = node.boolean_or("kinematic", false);
  if (body.fixed && body.kinematic) node.get("kinematic").fail("the body is fixed: it cannot move as well");
  body.X_WB = read_world_pose(draft, node, "pose");
  std::vector<world::Shape> shapes = read_shapes(draft, node);
  read_motion(draft, node, shapes, body);
  const world::BodyId id = draft.add_body(body, node.place());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    shapes[i].body = id;
    draft.add_shape(shapes[i], node.get("shapes").at(i).place());
  }
}

}  // namespace visum::scene
