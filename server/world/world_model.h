// The constant half of a world: its bodies, shapes, joints, surfaces and engines. A scene (or a test) builds
// it once, find_fault() checks it, and then it does not change while the world ticks. Adding or removing a
// body makes a new model.
//
// Frames: W world (right-handed, z up), B a body's link frame (as in the URDF), C its centre of mass (axes
// parallel to B), S a shape, J a joint. p_BC is the vector from B's origin to C's, in B. X_BS maps S
// coordinates to B. SI units, radians. Quaternions as Eigen's.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/world/curve.h"
#include "server/world/ids.h"

namespace visum::world {

struct Pose {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();

  Pose operator*(const Pose& other) const { return {p + q * other.p, (q * other.q).normalized()}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return p + q * point; }
  Pose inverse() const { return {q.conjugate() * -p, q.conjugate()}; }
};

// The material of a shape, as far as contacts need it. Where two surfaces touch, friction is the geometric
// mean and everything else the larger of both.
struct Surface {
  std::string name;
  double friction = 0.8;            // Coulomb, >= 0
  double restitution = 0.0;         // 0..1
  double rolling_friction = 0.0;    // m, >= 0: torque against rolling for each N of the normal force
  double torsional_friction = 0.0;  // m, >= 0: the same against spinning about the normal
};

struct TriangleMesh {
  std::string name;
  std::vector<Eigen::Vector3d> vertices;  // in the shape's frame, scaled
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

enum class ShapeKind { kBox, kSphere, kCylinder, kCapsule, kPlane, kConvex, kMesh };

struct Shape {
  std::string name;
  BodyId body;
  ShapeKind kind = ShapeKind::kBox;
  // box: full lengths x y z; sphere: radius; cylinder, capsule: radius, length along z (capsule: without the
  // caps); plane: nothing (its frame's z = 0, solid below); convex, mesh: nothing.
  std::array<double, 3> size{};
  MeshId mesh;  // convex: the hull of its vertices
  Pose X_BS;
  SurfaceId surface;
  bool collides = true;  // false: the shape is only seen
  std::array<double, 4> color{0.7, 0.7, 0.7, 1.0};
  std::int32_t material = -1;  // for viewers: index into the scene's materials; -1: the colour alone
};

inline constexpr std::int32_t kNoEngine = -1;

struct Body {
  std::string name;    // "box", "arm/link_3"
  std::string model;   // "arm"; empty: belongs to no model
  bool fixed = false;  // scenery: never moves, and needs no mass and inertia
  // Moves as it is told (server/world/placing.h): pushes others and is not pushed, and needs no mass. Its
  // `engine` is kNoEngine, so that every engine takes it for a body that moves by itself.
  bool kinematic = false;
  double mass_kg = 0.0;
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_C = Eigen::Matrix3d::Zero();  // kg·m², about C, axes of B
  std::int32_t engine = 0;                              // index into WorldModel::engines; kNoEngine
  Pose X_WB;                                            // initial
  Eigen::Vector3d v_WB = Eigen::Vector3d::Zero();       // initial velocity of B's origin, in W
  Eigen::Vector3d w_WB = Eigen::Vector3d::Zero();       // initial angular velocity, in W
};

// joint_kinds.h says what each kind holds and measures.
enum class JointKind {
  kFixed,
  kHinge,
  kSlider,
  kBall,
  kUniversal,
  kCylindrical,
  kScrew,
  kPointOnPlane,
  kPointOnLine,
  kPointOnCurve,
  kSpring,
  kTorsionSpring
};

// The child moves against the parent about (hinge) or along (slider) axis_J. At position 0 the frame J seen
// from the parent (X_PJ) and seen from the child (X_CJ) is the same in W. A spring runs from X_PJ.p to
// X_CJ.p.
struct Joint {
  std::string name;  // "arm/joint_3"
  JointKind kind = JointKind::kHinge;
  BodyId parent;  // invalid: the world
  BodyId child;
  Pose X_PJ;                                          // in the parent's B frame, or in W
  Pose X_CJ;                                          // in the child's B frame
  Eigen::Vector3d axis_J = Eigen::Vector3d::UnitZ();  // unit
  // Universal: the axis on the child, unit, perpendicular to axis_J.
  Eigen::Vector3d axis2_J = Eigen::Vector3d::UnitX();
  double pitch_m = 0.0;    // screw: along the axis per turn
  Curve curve_J;           // point on curve: in the parent's J
  double stiffness = 0.0;  // springs: N/m or N·m/rad
  double rest = 0.0;       // springs: length or angle without a load
  bool limited = false;
  double lower = 0.0;  // mechanical stops
  double upper = 0.0;
  double stop_restitution = 0.0;
  double friction = 0.0;  // constant, N·m or N; acts where no part drives the joint
  double damping = 0.0;   // N·m·s/rad or N·s/m; acts where no part drives the joint, and in a spring
  double initial_position = 0.0;
};

// Settings of one engine instance, as the scene gives them.
struct EngineSetting {
  std::string name;               // row of the engine table, "ode"
  std::string step = "world";     // ode: "world" (dWorldStep) or "quick" (QuickStep)
  int iterations = 20;            // ode quick
  double erp = 0.2;               // ode: share of a joint's error that is corrected per step
  double cfm = 1e-9;              // ode: softness; >= 1e-9 keeps contradictory joints solvable
  std::string solver = "direct";  // impulse: "direct" (all joints of a mechanism at once) or "iterate"
  int order = 2;                  // impulse: order of the step's error, 2, 4 or 6
  double d_max = 0.0;    // impulse: gap that a joint may have, m and rad; 0: chosen to suit the order
  double v_max = 1e-4;   // impulse iterate: relative velocity that a joint may have, m/s and rad/s
  int budget = 100;      // impulse iterate: corrections of each joint per tick
  double sleep_s = 0.0;  // impulse: bodies that stood still for so long sleep; 0: none ever sleeps
  std::string impact = "newton";  // impulse: "newton" or "poisson", the meaning of restitution
  // Work that one tick may take. impulse: in row updates (server/dynamics/impulse/work_budget.h). ode: rows
  // that the direct solver may have; beyond, the tick is made by QuickStep. 0: the engine's own limit, which
  // impulse raises with the contacts.
  std::uint64_t work_limit = 0;
  int threads = 1;  // impulse: that solve islands side by side; the state does not depend on it
};

inline constexpr int kMostThreads = 64;                           // of one engine
inline constexpr std::uint64_t kCollisionWorkLimit = 30'000'000;  // unless the scene says otherwise

// Contacts are found by the stage of our own, or FCL's broad and narrow phase (collision/fcl_stage.h).
enum class CollisionKind { kVisum, kFcl };

struct WorldModel {
  std::string name;
  std::int64_t tick_ns = 1'000'000;
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  // m/s²
  CollisionKind collision_stage = CollisionKind::kVisum;
  bool continuous_collision = true;  // fast bodies are kept from passing through others
  std::vector<EngineSetting> engines;
  std::uint64_t collision_work_limit = kCollisionWorkLimit;  // of one tick (server/collision/work.h)
  std::vector<Surface> surfaces;                             // [0] is the default
  std::vector<TriangleMesh> meshes;
  std::vector<Body> bodies;
  std::vector<Shape> shapes;  // sorted by body
  std::vector<Joint> joints;  // parents before children within a model
  // Pairs of bodies that never collide, a < b, sorted. The bodies that a joint connects are always among
  // them.
  std::vector<std::pair<BodyId, BodyId>> no_collision;

  // By name; invalid where there is none.
  BodyId find_body(const std::string& name) const;
  JointId find_joint(const std::string& name) const;
};

inline constexpr std::size_t kMaxBodies = 10'000;
inline constexpr std::size_t kMaxTriangles = 2'000'000;

// Looks for everything that would make an engine abort or compute nonsense: numbers that are not finite, a
// mass of 0, moments of inertia with A + B < C, quaternions and axes that are not of unit length, bad sizes
// and mesh indices, joints between two engines, and lists beyond their caps. Returns the first fault in
// words, empty if there is none.
std::string find_fault(const WorldModel& model);

// The same for one thing alone, which `model` need not hold yet: a reader of scenes asks about each thing
// where it stands in the file. Faults that lie between things (two bodies of one name, the order of joints)
// show only in the whole model. The ids in a shape or joint refer to `model`; a shape answers for its surface
// and its mesh, too.
std::string fault_of(const WorldModel& model, const Body& body);
std::string fault_of(const WorldModel& model, const Shape& shape);
std::string fault_of(const WorldModel& model, const Joint& joint);

}  // namespace visum::world
