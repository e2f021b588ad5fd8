#include "server/dynamics/ode/ode_stops.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace visum::dynamics::ode {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// A stop that is farther away than this (rad) is moved up to this distance. At least one of both stops is
// then within ODE's half turn. Otherwise ODE would neither test them nor forget an earlier touch.
constexpr double kReach = 1.0;

void set_hinge_stops(dJointID joint, const world::Joint& model, double position) {
  const double angle = dJointGetHingeAngle(joint);
  const double unwrapped = angle + kTurn * std::round((position - angle) / kTurn);
  dJointSetHingeParam(joint, dParamLoStop, angle + std::max(model.lower - unwrapped, -kReach));
  dJointSetHingeParam(joint, dParamHiStop, angle + std::min(model.upper - unwrapped, kReach));
}

}  // namespace

void prepare_stops(dJointID joint, const world::Joint& model, const world::EngineSetting& setting) {
  if (!model.limited) return;
  const auto set = model.kind == world::JointKind::kHinge ? dJointSetHingeParam : dJointSetSliderParam;
  set(joint, dParamStopERP, setting.erp);
  set(joint, dParamStopCFM, setting.cfm);
  set(joint, dParamBounce, model.stop_restitution);
  if (model.kind == world::JointKind::kHinge) return;
  set(joint, dParamLoStop, model.lower);
  set(joint, dParamHiStop, model.upper);
}

void set_stops(dJointID joint, const world::Joint& model, double position) {
  if (model.limited && model.kind == world::JointKind::kHinge) set_hinge_stops(joint, model, position);
}

}  // namespace visum::dynamics::ode
