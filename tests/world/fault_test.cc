#include <gmock/gmock.h>

#include <functional>

#include "tests/world/model.h"

namespace visum::world::testing {
namespace {

TEST(FindFault, AGoodModelHasNone) {
  EXPECT_EQ(find_fault(good_model()), "");
}

struct Spoilt {
  const char* name;
  std::function<void(WorldModel&)> spoil;
  const char* fault;

  friend void PrintTo(const Spoilt& spoilt, std::ostream* out) { *out << spoilt.name; }
};

const std::vector<Spoilt> kSpoilt{
    {"TickZero", [](WorldModel& m) { m.tick_ns = 0; }, "the tick must be between"},
    {"TickNegative", [](WorldModel& m) { m.tick_ns = -5; }, "the tick must be between"},
    {"TickTooLong", [](WorldModel& m) { m.tick_ns = 2'000'000'000; }, "the tick must be between"},
    {"GravityNan", [](WorldModel& m) { m.gravity.z() = kNan; }, "gravity is not finite"},
    {"GravityInfinite", [](WorldModel& m) { m.gravity.x() = kInf; }, "gravity is not finite"},
    {"NoIterations", [](WorldModel& m) { m.engines[0].iterations = 0; }, "engine 'ode' needs 1 to"},
    {"ErpAboveOne", [](WorldModel& m) { m.engines[0].erp = 1.5; }, "engine 'ode' needs an erp"},
    {"ErpNan", [](WorldModel& m) { m.engines[0].erp = kNan; }, "engine 'ode' needs an erp"},
    {"CfmZero", [](WorldModel& m) { m.engines[0].cfm = 0.0; }, "engine 'ode' needs a cfm"},
    {"CfmInfinite", [](WorldModel& m) { m.engines[1].cfm = kInf; }, "engine 'ode' needs a cfm"},
    {"BodyWithoutName", [](WorldModel& m) { m.bodies[3].name.clear(); }, "has no name"},
    {"TwoBodiesOfOneName", [](WorldModel& m) { m.bodies[3].name = "link_1"; }, "two bodies called 'link_1'"},
    {"MassZero", [](WorldModel& m) { m.bodies[3].mass_kg = 0.0; }, "body 'box' needs a mass"},
    {"MassNegative", [](WorldModel& m) { m.bodies[3].mass_kg = -1.0; }, "body 'box' needs a mass"},
    {"MassNan", [](WorldModel& m) { m.bodies[3].mass_kg = kNan; }, "body 'box' needs a mass"},
    {"MassInfinite", [](WorldModel& m) { m.bodies[3].mass_kg = kInf; }, "body 'box' needs a mass"},
    {"InertiaNan", [](WorldModel& m) { m.bodies[3].inertia_C(0, 1) = kNan; },
     "body 'box' has an inertia that is not finite"},
    {"InertiaZero", [](WorldModel& m) { m.bodies[3].inertia_C.setZero(); },
     "moment of inertia that is not positive"},
    {"InertiaAskew", [](WorldModel& m) { m.bodies[3].inertia_C(0, 1) = 0.01; }, "not symmetric"},
    {"InertiaNegative", [](WorldModel& m) { m.bodies[3].inertia_C *= -1.0; }, "not positive"},
    {"InertiaOfNoSolid", [](WorldModel& m) { m.bodies[3].inertia_C(2, 2) = 0.31; }, "A + B < C"},
    {"PositionNan", [](WorldModel& m) { m.bodies[3].X_WB.p.y() = kNan; }, "body 'box' has a position"},
    {"PositionFar", [](WorldModel& m) { m.bodies[3].X_WB.p.y() = 1e7; }, "body 'box' has a position"},
    {"QuaternionZero", [](WorldModel& m) { m.bodies[3].X_WB.q.coeffs().setZero(); },
     "body 'box' has a quaternion"},
    {"QuaternionLong", [](WorldModel& m) { m.bodies[0].X_WB.q.coeffs() *= 1.1; },
     "body 'ground' has a quaternion"},
    {"QuaternionNan", [](WorldModel& m) { m.bodies[3].X_WB.q.w() = kNan; }, "body 'box' has a quaternion"},
    {"VelocityInfinite", [](WorldModel& m) { m.bodies[3].v_WB.x() = kInf; }, "body 'box' has a velocity"},
    {"SpinNan", [](WorldModel& m) { m.bodies[3].w_WB.x() = kNan; }, "body 'box' has an angular velocity"},
    {"CentreOfMassNan", [](WorldModel& m) { m.bodies[3].p_BC.x() = kNan; },
     "body 'box' has a centre of mass"},
    {"FixedBodyMoves", [](WorldModel& m) { m.bodies[0].v_WB.x() = 1.0; },
     "body 'ground' is fixed and has a velocity"},
    {"NoSuchEngine", [](WorldModel& m) { m.bodies[3].engine = 2; }, "body 'box' is to be moved by an engine"},
    {"NegativeEngine", [](WorldModel& m) { m.bodies[3].engine = -1; },
     "body 'box' is to be moved by an engine"},
    {"FrictionNegative", [](WorldModel& m) { m.surfaces[0].friction = -0.1; },
     "surface 'default' needs a friction"},
    {"FrictionNan", [](WorldModel& m) { m.surfaces[0].friction = kNan; },
     "surface 'default' needs a friction"},
    {"RestitutionAboveOne", [](WorldModel& m) { m.surfaces[0].restitution = 1.1; },
     "surface 'default' needs a restitution"},
    {"MeshEmpty", [](WorldModel& m) { m.meshes[0].vertices.clear(); }, "mesh 'tetrahedron' has no vertices"},
    {"MeshVertexNan", [](WorldModel& m) { m.meshes[0].vertices[1].x() = kNan; },
     "mesh 'tetrahedron' has a vertex"},
    {"MeshIndexTooHigh", [](WorldModel& m) { m.meshes[0].triangles[1][2] = 4; },
     "with a vertex that does not exist"},
    {"MeshIndexHuge", [](WorldModel& m) { m.meshes[0].triangles[1][2] = 0xffffffffu; },
     "with a vertex that does not exist"},
    {"MeshWithoutTriangles",
     [](WorldModel& m) {
       m.shapes[2].kind = ShapeKind::kMesh;
       m.meshes[0].triangles.clear();
     },
     "shape 'shape_2' has a mesh without triangles"},
    {"HullFlat",
     [](WorldModel& m) {
       m.meshes[0].vertices[3] = {1, 1, 0};
     },
     "shape 'shape_2' is a hull without volume"},
    {"HullOfThreePoints",
     [](WorldModel& m) {
       m.meshes[0].vertices.pop_back();
       m.meshes[0].triangles.clear();
     },
     "is a hull without volume"},
    {"HullWithoutMesh", [](WorldModel& m) { m.shapes[2].mesh = {}; }, "shape 'shape_2' has no mesh"},
    {"HullOfAnotherMesh", [](WorldModel& m) { m.shapes[2].mesh = {7}; }, "shape 'shape_2' has no mesh"},
    {"ShapeOnNoBody", [](WorldModel& m) { m.shapes[3].body = {}; }, "shape 'shape_3' is on no body"},
    {"ShapeWithoutSurface", [](WorldModel& m) { m.shapes[3].surface = {3}; },
     "shape 'shape_3' has no surface"},
    {"ShapesOutOfOrder", [](WorldModel& m) { std::swap(m.shapes[1], m.shapes[3]); },
     "not in the order of the bodies"},
    {"BoxFlat", [](WorldModel& m) { m.shapes[3].size[1] = 0.0; }, "shape 'shape_3' needs sizes"},
    {"BoxNegative", [](WorldModel& m) { m.shapes[3].size[2] = -1.0; }, "shape 'shape_3' needs sizes"},
    {"CylinderRadiusNan", [](WorldModel& m) { m.shapes[1].size[0] = kNan; }, "shape 'shape_1' needs sizes"},
    {"CylinderInfinite", [](WorldModel& m) { m.shapes[1].size[1] = kInf; }, "shape 'shape_1' needs sizes"},
    {"ShapePoseNan", [](WorldModel& m) { m.shapes[3].X_BS.p.x() = kNan; }, "shape 'shape_3' has a position"},
    {"UnknownKind", [](WorldModel& m) { m.shapes[3].kind = static_cast<ShapeKind>(99); }, "of no known kind"},
    {"PlaneOnAMovingBody", [](WorldModel& m) { m.shapes[3].kind = ShapeKind::kPlane; },
     "is a plane on a body that moves"},
    {"JointWithoutName", [](WorldModel& m) { m.joints[0].name.clear(); }, "has no name"},
    {"TwoJointsOfOneName", [](WorldModel& m) { m.joints[1].name = "hinge"; }, "two joints called 'hinge'"},
    {"JointWithoutChild", [](WorldModel& m) { m.joints[0].child = {}; }, "joint 'hinge' has no child"},
    {"JointToNobody", [](WorldModel& m) { m.joints[0].parent = {12}; },
     "joint 'hinge' has a parent that does not exist"},
    {"JointWithItself", [](WorldModel& m) { m.joints[1].parent = {2}; }, "connects a body with itself"},
    {"JointMovesTheGround", [](WorldModel& m) { std::swap(m.joints[0].parent, m.joints[0].child); },
     "has a child that is fixed"},
    {"JointAcrossEngines", [](WorldModel& m) { m.bodies[2].engine = 1; },
     "joint 'slider' connects bodies of two engines"},
    {"AxisZero", [](WorldModel& m) { m.joints[0].axis_J.setZero(); }, "joint 'hinge' has an axis"},
    {"AxisNan", [](WorldModel& m) { m.joints[0].axis_J.x() = kNan; }, "joint 'hinge' has an axis"},
    {"JointFrameNan", [](WorldModel& m) { m.joints[1].X_CJ.q.z() = kNan; },
     "joint 'slider' has a quaternion"},
    {"StopsCrossed",
     [](WorldModel& m) {
       m.joints[0].limited = true;
       m.joints[0].lower = 1;
     },
     "joint 'hinge' has stops"},
    {"StopNan",
     [](WorldModel& m) {
       m.joints[0].limited = true;
       m.joints[0].upper = kNan;
     },
     "joint 'hinge' has stops"},
    {"StartsBeyondItsStop",
     [](WorldModel& m) {
       m.joints[0].limited = true;
       m.joints[0].upper = 1;
       m.joints[0].initial_position = 2;
     },
     "joint 'hinge' starts beyond"},
    {"InitialPositionNan", [](WorldModel& m) { m.joints[0].initial_position = kNan; },
     "joint 'hinge' has an initial position"},
    {"JointFrictionNegative", [](WorldModel& m) { m.joints[0].friction = -1; },
     "joint 'hinge' needs a friction"},
    {"JointDampingNan", [](WorldModel& m) { m.joints[0].damping = kNan; }, "joint 'hinge' needs a damping"},
    {"SecondAxisAskew",
     [](WorldModel& m) {
       m.joints[0].kind = JointKind::kUniversal;
       m.joints[0].axis2_J = Eigen::Vector3d(1, 0, 1).normalized();
     },
     "joint 'hinge' has axes that are not perpendicular"},
    {"PitchNan",
     [](WorldModel& m) {
       m.joints[0].kind = JointKind::kScrew;
       m.joints[0].pitch_m = kNan;
     },
     "joint 'hinge' needs a pitch"},
    {"CurveMissing", [](WorldModel& m) { m.joints[0].kind = JointKind::kPointOnCurve; },
     "joint 'hinge' needs a curve"},
    {"SpringNegative",
     [](WorldModel& m) {
       m.joints[0].kind = JointKind::kSpring;
       m.joints[0].stiffness = -1;
     },
     "joint 'hinge' needs a stiffness"},
    {"StopsOfABall",
     [](WorldModel& m) {
       m.joints[0].kind = JointKind::kBall;
       m.joints[0].limited = true;
     },
     "joint 'hinge' has stops"},
    {"OrderOdd", [](WorldModel& m) { m.engines[0].order = 3; }, "engine 'ode' needs an order"},
    {"DMaxNan", [](WorldModel& m) { m.engines[0].d_max = kNan; }, "engine 'ode' needs a d_max"},
    {"BudgetZero", [](WorldModel& m) { m.engines[0].budget = 0; }, "engine 'ode' needs a budget"},
    {"JointsChildrenFirst", [](WorldModel& m) { std::swap(m.joints[0], m.joints[1]); },
     "joint 'hinge' stands after a joint below it"},
    {"JointsInACircle", [](WorldModel& m) { m.joints[0].parent = {2}; },
     "joint 'slider' stands after a joint below it, or closes a cycle"},
    {"PairUnsorted", [](WorldModel& m) { std::swap(m.no_collision[0], m.no_collision[1]); },
     "no_collision is not sorted"},
    {"PairTwice", [](WorldModel& m) { m.no_collision[1] = m.no_collision[0]; }, "no_collision is not sorted"},
    {"PairTurned",
     [](WorldModel& m) {
       m.no_collision[0] = {{1}, {0}};
     },
     "no_collision names a pair"},
    {"PairOfNobody",
     [](WorldModel& m) {
       m.no_collision[1] = {{1}, {20}};
     },
     "no_collision names a pair"},
    {"TooManyBodies", [](WorldModel& m) { m.bodies.resize(kMaxBodies + 1, m.bodies[3]); },
     "more than 10000 bodies"},
    {"TooManyTriangles",
     [](WorldModel& m) {
       m.meshes[0].triangles.resize(kMaxTriangles + 1, {0, 1, 2});
     },
     "more than 2000000 triangles"},
};

class FindFaultIn : public ::testing::TestWithParam<Spoilt> {};

TEST_P(FindFaultIn, NamesWhatIsWrong) {
  WorldModel model = good_model();
  GetParam().spoil(model);
  EXPECT_THAT(find_fault(model), ::testing::HasSubstr(GetParam().fault));
}

INSTANTIATE_TEST_SUITE_P(Model, FindFaultIn, ::testing::ValuesIn(kSpoilt),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(FindFault, ALoopClosedByASecondJointIsAllowed) {
  WorldModel model = good_model();
  Joint closing = model.joints[1];
  closing.name = "closing";
  closing.parent = {};
  model.joints.push_back(closing);
  EXPECT_EQ(find_fault(model), "");
}

// fault_of() checks one thing alone, which the model need not hold.
TEST(FaultOf, ABodyIsNamedWithItsFault) {
  const WorldModel model = good_model();
  Body body = model.bodies[3];
  EXPECT_EQ(fault_of(model, body), "");
  body.mass_kg = 0.0;
  EXPECT_EQ(fault_of(model, body), "body 'box' needs a mass between 1e-9 and 1e12 kg");
  body = model.bodies[3];
  body.engine = 2;
  EXPECT_EQ(fault_of(model, body), "body 'box' is to be moved by an engine that does not exist");
}

TEST(FaultOf, AShapeAnswersForItsSurfaceAndItsMeshToo) {
  WorldModel model = good_model();
  Shape box = model.shapes[3];
  const Shape hull = model.shapes[2];
  EXPECT_EQ(fault_of(model, box), "");
  EXPECT_EQ(fault_of(model, hull), "");
  box.size[1] = 0.0;
  EXPECT_EQ(fault_of(model, box), "shape 'shape_3' needs sizes between 1e-6 and 1e6 m");
  box.surface = {3};
  EXPECT_EQ(fault_of(model, box), "shape 'shape_3' has no surface");
  model.meshes[0].vertices[1].x() = kNan;
  EXPECT_EQ(fault_of(model, model.shapes[3]), "") << "another shape's mesh does not matter";
  EXPECT_EQ(fault_of(model, hull), "mesh 'tetrahedron' has a vertex that is not finite or beyond 1e6 m");
  model.surfaces[0].friction = -0.1;
  EXPECT_EQ(fault_of(model, hull), "surface 'default' needs a friction of at least 0");
}

TEST(FaultOf, AJointIsCheckedAgainstTheBodiesOfTheModel) {
  const WorldModel model = good_model();
  Joint joint = model.joints[1];
  EXPECT_EQ(fault_of(model, joint), "");
  joint.parent = joint.child;
  EXPECT_EQ(fault_of(model, joint), "joint 'slider' connects a body with itself");
  joint.parent = {12};
  EXPECT_EQ(fault_of(model, joint), "joint 'slider' has a parent that does not exist");
  joint = model.joints[1];
  std::swap(joint.parent, joint.child);
  EXPECT_EQ(fault_of(model, joint), "") << "the order of the joints shows only in the whole model";
}

TEST(WorldModel, FindsBodiesAndJointsByName) {
  const WorldModel model = good_model();
  EXPECT_EQ(model.find_body("link_2"), BodyId{2});
  EXPECT_EQ(model.find_joint("slider"), JointId{1});
  EXPECT_FALSE(model.find_body("nobody").valid());
  EXPECT_FALSE(model.find_joint("").valid());
}

}  // namespace
}  // namespace visum::world::testing
