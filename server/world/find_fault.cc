#include <Eigen/Eigenvalues>
#include <unordered_set>

#include "server/world/fault_text.h"

namespace visum::world {
namespace {

constexpr std::int64_t kMaxTickNs = 1'000'000'000;
constexpr double kMinCfm = 1e-9;  // below, ODE's direct solver aborts on contradictory joints
constexpr int kMaxIterations = 100'000;
constexpr double kMinMassKg = 1e-9;
constexpr double kMaxMassKg = 1e12;
constexpr double kInertiaTolerance = 1e-6;  // relative: files with six digits are off by so much

std::string engine_fault(const EngineSetting& engine) {
  if (engine.iterations < 1 || engine.iterations > kMaxIterations) return "needs 1 to 100000 iterations";
  if (!is_in_range(engine.erp, 0.0, 1.0)) return "needs an erp from 0 to 1";
  if (!is_in_range(engine.cfm, kMinCfm, kMaxMagnitude)) return "needs a cfm of at least 1e-9";
  if (engine.order != 2 && engine.order != 4 && engine.order != 6) return "needs an order of 2, 4 or 6";
  if (!is_in_range(engine.d_max, 0.0, 1.0)) return "needs a d_max from 0 to 1";
  if (!is_in_range(engine.v_max, 0.0, kMaxMagnitude)) return "needs a v_max from 0 to 1e6";
  if (engine.budget < 1 || engine.budget > kMaxIterations) return "needs a budget of 1 to 100000";
  return "";
}

std::string find_setting_fault(const WorldModel& model) {
  if (model.tick_ns < 1 || model.tick_ns > kMaxTickNs) return "the tick must be between 1 ns and 1 s";
  if (!is_placed(model.gravity)) return "gravity is not finite or beyond 1e6 m/s²";
  for (const EngineSetting& engine : model.engines) {
    if (const std::string fault = engine_fault(engine); !fault.empty())
      return "engine " + quoted(engine.name) + " " + fault;
  }
  return "";
}

// The triangle inequality A + B >= C tells the inertia of a real solid from three arbitrary numbers.
std::string inertia_fault(const Eigen::Matrix3d& inertia) {
  if (!inertia.allFinite()) return "has an inertia that is not finite";
  const double scale = inertia.cwiseAbs().maxCoeff();
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() > kInertiaTolerance * scale)
    return "has an inertia that is not symmetric";
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d moments = solver.eigenvalues();  // ascending
  if (!(moments[0] > 0.0)) return "has a principal moment of inertia that is not positive";
  if (moments[0] + moments[1] < moments[2] * (1.0 - kInertiaTolerance))
    return "has principal moments of inertia that no solid has (A + B < C)";
  return "";
}

std::string moving_body_fault(const WorldModel& model, const Body& body) {
  if (!is_in_range(body.mass_kg, kMinMassKg, kMaxMassKg)) return "needs a mass between 1e-9 and 1e12 kg";
  if (!is_placed(body.p_BC)) return "has a centre of mass that is not finite or beyond 1e6 m";
  if (!is_placed(body.v_WB)) return "has a velocity that is not finite or beyond 1e6 m/s";
  if (!is_placed(body.w_WB)) return "has an angular velocity that is not finite or beyond 1e6 rad/s";
  if (body.engine < 0 || static_cast<std::size_t>(body.engine) >= model.engines.size())
    return "is to be moved by an engine that does not exist";
  return inertia_fault(body.inertia_C);
}

std::string kinematic_body_fault(const Body& body) {
  if (body.engine != kNoEngine) return "is kinematic and is to be moved by an engine";
  if (!is_placed(body.p_BC)) return "has a centre of mass that is not finite or beyond 1e6 m";
  if (!is_placed(body.v_WB)) return "has a velocity that is not finite or beyond 1e6 m/s";
  if (!is_placed(body.w_WB)) return "has an angular velocity that is not finite or beyond 1e6 rad/s";
  return "";
}

std::string fixed_body_fault(const Body& body) {
  if (!is_placed(body.p_BC)) return "has a centre of mass that is not finite or beyond 1e6 m";
  if (!body.v_WB.isZero(0.0) || !body.w_WB.isZero(0.0)) return "is fixed and has a velocity";
  return "";
}

std::string body_fault(const WorldModel& model, const Body& body) {
  if (body.name.empty()) return "has no name";
  if (const std::string fault = pose_fault(body.X_WB); !fault.empty()) return fault;
  if (body.fixed) return body.kinematic ? "is both fixed and kinematic" : fixed_body_fault(body);
  return body.kinematic ? kinematic_body_fault(body) : moving_body_fault(model, body);
}

std::string find_body_fault(const WorldModel& model) {
  if (model.bodies.size() > kMaxBodies)
    return "there are more than " + std::to_string(kMaxBodies) + " bodies";
  std::unordered_set<std::string> names;
  for (const Body& body : model.bodies) {
    if (std::string fault = fault_of(model, body); !fault.empty()) return fault;
    if (!names.insert(body.name).second) return "there are two bodies called " + quoted(body.name);
  }
  return "";
}

std::string find_pair_fault(const WorldModel& model) {
  const std::pair<BodyId, BodyId>* previous = nullptr;
  for (const auto& pair : model.no_collision) {
    const bool known = pair.first.valid() && pair.second.index() < model.bodies.size();
    if (!known || !(pair.first < pair.second))
      return "no_collision names a pair of bodies that does not exist";
    if (previous != nullptr && !(*previous < pair)) return "no_collision is not sorted or names a pair twice";
    previous = &pair;
  }
  return "";
}

}  // namespace

std::string fault_of(const WorldModel& model, const Body& body) {
  const std::string fault = body_fault(model, body);
  return fault.empty() ? "" : "body " + quoted(body.name) + " " + fault;
}

std::string find_fault(const WorldModel& model) {
  for (const auto find :
       {find_setting_fault, find_body_fault, find_shape_fault, find_joint_fault, find_pair_fault}) {
    if (std::string fault = find(model); !fault.empty()) return fault;
  }
  return "";
}

}  // namespace visum::world
