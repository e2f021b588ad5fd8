#include "tests/bench/peers/mjcf.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "server/world/joint_kinds.h"
#include "server/world/joint_tree.h"

namespace visum::bench {
namespace {

using Eigen::Vector3d;
using world::JointKind;
using world::Pose;

// By body: the spring beside the joint that carries it. Null: none.
std::vector<const world::Joint*> springs_by_child(const world::WorldModel& model) {
  std::vector<const world::Joint*> springs(model.bodies.size(), nullptr);
  for (const world::Joint& joint : model.joints)
    if (joint.kind == JointKind::kTorsionSpring) springs[joint.child.index()] = &joint;
  return springs;
}

bool closes_loop(const std::vector<world::JointId>& carrying, const world::WorldModel& model,
                 std::size_t joint) {
  const world::Joint& it = model.joints[joint];
  return world::info(it.kind).holds_anything && carrying[it.child.index()].index() != joint;
}

// How many contacts MuJoCo keeps room for. In a pile a box may touch five others with up to eight points
// each; a limb touches the ground, or its neighbours.
std::size_t contacts_of(const world::WorldModel& model) {
  constexpr std::size_t kSphere = 2, kFreeBox = 24, kLimb = 6;
  std::size_t contacts = 0;
  for (const world::Shape& shape : model.shapes)
    contacts += shape.kind == world::ShapeKind::kSphere ? kSphere : model.joints.empty() ? kFreeBox : kLimb;
  return contacts;
}

class Writer {
 public:
  Writer(const world::WorldModel& model, const char* integrator)
      : model_(model), carrying_(carrying_joints(model)), springs_(springs_by_child(model)) {
    out_ << std::setprecision(17) << "<mujoco><compiler angle=\"radian\" inertiafromgeom=\"false\"/>"
         << "<option timestep=\"" << 1e-9 * static_cast<double>(model.tick_ns) << "\" integrator=\""
         << integrator << '"';
    attribute("gravity", model.gravity);
    for (std::size_t i = 0; i < model.joints.size(); ++i)
      if (closes_loop(carrying_, model, i)) closing_.push_back(&model.joints[i]);
    out_ << ">" << (model.shapes.empty() ? "<flag contact=\"disable\"/>" : "") << "</option>";
  }

  std::string text() {
    size();
    out_ << "<worldbody>";
    children_of({});
    out_ << "</worldbody><contact>";
    for (const auto& [a, b] : model_.no_collision) exclude(a, b);
    for (const world::Joint* joint : closing_) exclude(joint->parent, joint->child);
    out_ << "</contact><equality>";
    for (const world::Joint* joint : closing_) connect(*joint);
    out_ << "</equality></mujoco>";
    return out_.str();
  }

 private:
  // MuJoCo's own guess is too small for a stack of 50: it then leaves contacts out.
  void size() {
    if (!model_.shapes.empty())
      out_ << "<size nconmax=\"" << contacts_of(model_) << "\" njmax=\"" << mjcf_rows(model_) << "\"/>";
  }

  void attribute(const char* name, const Vector3d& v) {
    out_ << ' ' << name << "=\"" << v.x() << ' ' << v.y() << ' ' << v.z() << '"';
  }

  void pose(const Pose& X) {
    attribute("pos", X.p);
    out_ << " quat=\"" << X.q.w() << ' ' << X.q.x() << ' ' << X.q.y() << ' ' << X.q.z() << '"';
  }

  // Bodies that a joint carries are nested in their parent, all others in the world.
  void children_of(world::BodyId parent) {
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      const world::JointId carrier = carrying_[i];
      const world::BodyId held_by = carrier.valid() ? model_.joints[carrier.index()].parent : world::BodyId{};
      if (held_by == parent) body({static_cast<std::int32_t>(i)}, carrier);
    }
  }

  void body(world::BodyId id, world::JointId carrier) {
    const world::Body& body = model_.bodies[id.index()];
    if (body.fixed) return shapes(id, body.X_WB);
    Pose X = body.X_WB;
    if (carrier.valid()) {
      const world::Joint& joint = model_.joints[carrier.index()];
      X = joint.X_PJ * joint.X_CJ.inverse();
    }
    out_ << "<body name=\"" << body.name << '"';
    pose(X);
    out_ << ">";
    if (carrier.valid())
      joint(model_.joints[carrier.index()]);
    else
      out_ << "<freejoint/>";
    inertial(body);
    shapes(id, {});
    children_of(id);
    out_ << "</body>";
  }

  // A body without a joint is welded to its parent.
  void joint(const world::Joint& joint) {
    if (joint.kind == JointKind::kFixed) return;
    const bool ball = joint.kind == JointKind::kBall;
    out_ << "<joint type=\"" << (ball ? "ball" : "hinge") << "\" name=\"" << joint.name << '"';
    attribute("pos", joint.X_CJ.p);
    if (!ball) hinge(joint);
    out_ << "/>";
  }

  void hinge(const world::Joint& joint) {
    const world::Joint* spring = springs_[joint.child.index()];
    attribute("axis", joint.X_CJ.q * joint.axis_J);
    if (joint.limited) out_ << " limited=\"true\" range=\"" << joint.lower << ' ' << joint.upper << '"';
    out_ << " frictionloss=\"" << joint.friction << "\" damping=\""
         << joint.damping + (spring ? spring->damping : 0.0) << '"';
    if (spring) out_ << " stiffness=\"" << spring->stiffness << "\" springref=\"" << spring->rest << '"';
  }

  void inertial(const world::Body& body) {
    const Eigen::Matrix3d& j = body.inertia_C;
    out_ << "<inertial mass=\"" << body.mass_kg << '"';
    attribute("pos", body.p_BC);
    out_ << " fullinertia=\"" << j(0, 0) << ' ' << j(1, 1) << ' ' << j(2, 2) << ' ' << j(0, 1) << ' '
         << j(0, 2) << ' ' << j(1, 2) << "\"/>";
  }

  // The friction of a pair is the larger of both. With the same number on every surface, all engines agree.
  void shapes(world::BodyId id, const Pose& X_B) {
    for (const world::Shape& shape : model_.shapes) {
      if (shape.body != id) continue;
      const auto& [x, y, z] = shape.size;
      const bool plane = shape.kind == world::ShapeKind::kPlane;
      const bool sphere = shape.kind == world::ShapeKind::kSphere;
      out_ << "<geom type=\"" << (plane ? "plane" : sphere ? "sphere" : "box") << '"';
      attribute("size", plane    ? Vector3d(10.0, 10.0, 0.1)
                        : sphere ? Vector3d(x, 0.0, 0.0)
                                 : Vector3d(0.5 * x, 0.5 * y, 0.5 * z));
      pose(X_B * shape.X_BS);
      out_ << " condim=\"3\" friction=\"" << model_.surfaces[shape.surface.index()].friction
           << " 0.005 0.0001\"/>";
    }
  }

  // MuJoCo itself leaves out the pairs of a body and its parent in the tree.
  void exclude(world::BodyId a, world::BodyId b) {
    if (!a.valid() || !b.valid()) return;
    out_ << "<exclude body1=\"" << model_.bodies[a.index()].name << "\" body2=\""
         << model_.bodies[b.index()].name << "\"/>";
  }

  void connect(const world::Joint& joint) {
    out_ << "<connect body1=\"" << model_.bodies[joint.child.index()].name << '"';
    if (joint.parent.valid()) out_ << " body2=\"" << model_.bodies[joint.parent.index()].name << '"';
    attribute("anchor", joint.X_CJ.p);
    out_ << "/>";
  }

  const world::WorldModel& model_;
  const std::vector<world::JointId> carrying_;
  const std::vector<const world::Joint*> springs_;
  std::vector<const world::Joint*> closing_;  // the joints that close loops
  std::ostringstream out_;
};

}  // namespace

int mjcf_depth(const world::WorldModel& model) {
  int deepest = 0;
  std::vector<int> depth(model.bodies.size(), 0);
  const auto carrying = carrying_joints(model);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const auto& joint = model.joints[i];
    if (carrying[joint.child.index()].index() != i) continue;
    depth[joint.child.index()] = 1 + (joint.parent.valid() ? depth[joint.parent.index()] : 0);
    deepest = std::max(deepest, depth[joint.child.index()]);
  }
  return deepest;
}

std::size_t mjcf_rows(const world::WorldModel& model) {
  constexpr std::size_t kByContact = 4, kByLoop = 3;
  const auto carrying = carrying_joints(model);
  std::size_t rows = kByContact * contacts_of(model);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const world::Joint& joint = model.joints[i];
    rows += (joint.friction > 0.0) + joint.limited;
    if (closes_loop(carrying, model, i)) rows += kByLoop;
  }
  return rows;
}

std::string mjcf(const world::WorldModel& model, const char* integrator) {
  return Writer(model, integrator).text();
}

}  // namespace visum::bench
