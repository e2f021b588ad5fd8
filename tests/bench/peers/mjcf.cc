#include "tests/bench/peers/mjcf.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "server/world/joint_tree.h"

namespace visum::bench {
namespace {

using Eigen::Vector3d;
using world::Pose;

class Writer {
 public:
  Writer(const world::WorldModel& model, const char* integrator)
      : model_(model), carrying_(carrying_joints(model)) {
    out_ << std::setprecision(17) << "<mujoco><compiler angle=\"radian\" inertiafromgeom=\"false\"/>"
         << "<option timestep=\"" << 1e-9 * static_cast<double>(model.tick_ns) << "\" integrator=\""
         << integrator << '"';
    attribute("gravity", model.gravity);
    out_ << ">" << (model.shapes.empty() ? "<flag contact=\"disable\"/>" : "") << "</option>";
  }

  std::string text() {
    size();
    out_ << "<worldbody>";
    children_of({});
    out_ << "</worldbody><equality>";
    for (std::size_t i = 0; i < model_.joints.size(); ++i)
      if (carrying_[model_.joints[i].child.index()].index() != i) connect(model_.joints[i]);
    out_ << "</equality></mujoco>";
    return out_.str();
  }

 private:
  // MuJoCo's own guess is too small for a stack of 50: it then leaves contacts out.
  void size() {
    constexpr std::size_t kContacts = 24, kRows = 4 * kContacts;  // by shape
    if (!model_.shapes.empty())
      out_ << "<size nconmax=\"" << kContacts * model_.shapes.size() << "\" njmax=\""
           << kRows * model_.shapes.size() << "\"/>";
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
      hinge(model_.joints[carrier.index()]);
    else
      out_ << "<freejoint/>";
    inertial(body);
    shapes(id, {});
    children_of(id);
    out_ << "</body>";
  }

  void hinge(const world::Joint& joint) {
    out_ << "<joint type=\"hinge\" name=\"" << joint.name << '"';
    attribute("pos", joint.X_CJ.p);
    attribute("axis", joint.X_CJ.q * joint.axis_J);
    out_ << "/>";
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
      const bool plane = shape.kind == world::ShapeKind::kPlane;
      out_ << "<geom type=\"" << (plane ? "plane" : "box") << '"';
      attribute("size", plane ? Vector3d(10.0, 10.0, 0.1)
                              : Vector3d(0.5 * shape.size[0], 0.5 * shape.size[1], 0.5 * shape.size[2]));
      pose(X_B * shape.X_BS);
      out_ << " condim=\"3\" friction=\"" << model_.surfaces[shape.surface.index()].friction
           << " 0.005 0.0001\"/>";
    }
  }

  void connect(const world::Joint& joint) {
    out_ << "<connect body1=\"" << model_.bodies[joint.child.index()].name << '"';
    if (joint.parent.valid()) out_ << " body2=\"" << model_.bodies[joint.parent.index()].name << '"';
    attribute("anchor", joint.X_CJ.p);
    out_ << "/>";
  }

  const world::WorldModel& model_;
  const std::vector<world::JointId> carrying_;
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

std::string mjcf(const world::WorldModel& model, const char* integrator) {
  return Writer(model, integrator).text();
}

}  // namespace visum::bench
