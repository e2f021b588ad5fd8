// Simulation: bodies and joints that are put elsewhere between ticks, and pulls.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "server/cycle/simulation.h"

namespace visum::cycle {
namespace {

// A kinematic body that is set no farther away than this has moved; else it was taken to another place.
constexpr double kJumpM = 0.05;
constexpr double kJumpQuaternion = 0.05;  // distance of the two quaternions

bool has_jumped(const world::BodyState& from, const world::BodyState& to) {
  return (to.p_WC - from.p_WC).norm() > kJumpM ||
         std::min((to.q_WB.coeffs() - from.q_WB.coeffs()).norm(),
                  (to.q_WB.coeffs() + from.q_WB.coeffs()).norm()) > kJumpQuaternion;
}

}  // namespace

Outcome Simulation::accept_state(world::WorldState&& changed) {
  std::string offender;
  if (!world::is_sane(model(), changed, &offender)) return {Refusal::kBadValue, offender};
  bool jumped = false;
  for (std::size_t i = 0; i < changed.bodies.size(); ++i) {
    const auto &from = state_.bodies[i], &to = changed.bodies[i];
    const bool same = from.p_WC == to.p_WC && from.q_WB.coeffs() == to.q_WB.coeffs() &&
                      from.v_WC == to.v_WC && from.w_WB == to.w_WB;
    jumped = jumped || (!same && (!model().bodies[i].kinematic || has_jumped(from, to)));
  }
  state_ = std::move(changed);
  // Engines keep forces and sleep of where the bodies were.
  if (jumped)
    for (auto& kept : state_.engines) kept.clear();
  return {};
}

Outcome Simulation::set_body(world::BodyId body, const std::optional<world::Pose>& X_WB,
                             const Eigen::Vector3d& v_WB, const Eigen::Vector3d& w_WB) {
  if (frozen()) return {Refusal::kWrongState, "the world is frozen: " + fault_};
  if (auto fault = world::placing_fault(model(), body); !fault.empty())
    return {Refusal::kWrongState, std::move(fault)};
  auto to = world::placement_of(model().bodies[body.index()], state_.bodies[body.index()]);
  if (X_WB) to.X_WB = {X_WB->p, X_WB->q.normalized()};
  to.v_WB = v_WB;
  to.w_WB = w_WB;
  auto changed = state_;
  world::place_body(model(), body, to, changed);
  if (auto outcome = accept_state(std::move(changed)); !outcome.done()) return outcome;
  recording::SetBody input{
      body.value, X_WB.has_value(), {}, {v_WB.x(), v_WB.y(), v_WB.z()}, {w_WB.x(), w_WB.y(), w_WB.z()}};
  if (X_WB)
    input.pose = {X_WB->p.x(), X_WB->p.y(), X_WB->p.z(), X_WB->q.w(), X_WB->q.x(), X_WB->q.y(), X_WB->q.z()};
  tell(now(), input);
  return {};
}

// Followers go where their leaders send them, unless they are set as well.
void Simulation::add_followers(std::vector<world::JointPlacement>& to) const {
  const auto find = [&to](world::JointId joint) {
    return std::ranges::find(to, joint, &world::JointPlacement::joint);
  };
  for (const auto& follower : scene_->followers) {
    const auto leader = find(follower.leader);
    if (leader == to.end() || find(follower.joint) != to.end()) continue;
    const world::JointPlacement led{follower.joint, follower.multiplier * leader->position + follower.offset,
                                    follower.multiplier * leader->velocity};
    to.push_back(led);
  }
}

void Simulation::place_parts(std::span<const world::JointPlacement> to) {
  std::vector<std::size_t> moved;
  for (auto& bound : parts_) {
    moved.clear();
    for (std::size_t i = 0; i < bound.joints.size(); ++i)
      if (std::ranges::find(to, bound.joints[i], &world::JointPlacement::joint) != to.end())
        moved.push_back(i);
    if (moved.empty()) continue;
    for (std::size_t i = 0; i < bound.joints.size(); ++i) {
      const auto& joint = state_.joints[bound.joints[i].index()];
      bound.samples[i] = {joint.position, joint.velocity, 0.0};
    }
    bound.part->place(moved, bound.samples);
  }
  follow_parts();
}

Outcome Simulation::set_joints(std::span<const world::JointPlacement> given) {
  if (frozen()) return {Refusal::kWrongState, "the world is frozen: " + fault_};
  std::vector<world::JointPlacement> to(given.begin(), given.end());
  for (std::size_t i = 0; i < to.size(); ++i) {
    const auto& name = model().joints[to[i].joint.index()].name;
    if (std::ranges::find(given.first(i), to[i].joint, &world::JointPlacement::joint) != given.first(i).end())
      return {Refusal::kBadValue, "joint '" + name + "' is given twice"};
  }
  add_followers(to);
  for (const auto& joint : to)
    if (auto fault = world::placing_fault(model(), joint); !fault.empty())
      return {Refusal::kBadValue, std::move(fault)};
  auto changed = state_;
  world::place_joints(model(), to, changed);
  if (auto outcome = accept_state(std::move(changed)); !outcome.done()) return outcome;
  for (const auto& joint : to) state_.joints[joint.joint.index()].effort = 0.0;
  place_parts(to);
  std::vector<std::int32_t> joints;
  std::vector<double> positions, velocities;
  for (const auto& joint : given) {
    joints.push_back(joint.joint.value);
    positions.push_back(joint.position);
    velocities.push_back(joint.velocity);
  }
  tell(now(), recording::SetJoints{joints, positions, velocities});
  return {};
}

Outcome Simulation::pull(const Pull& pull) {
  const auto& body = model().bodies[pull.body.index()];
  if (body.fixed || body.kinematic)
    return {Refusal::kWrongState,
            "'" + body.name + "' is " + (body.fixed ? "fixed" : "kinematic") + ": no force moves it"};
  const auto found = std::ranges::find(pulls_, pull.body, &Pull::body);
  if (found != pulls_.end() && found->owner != pull.owner && found->owner != 0 && pull.owner != 0)
    return {Refusal::kWrongState, "'" + body.name + "' is pulled by another session"};
  if (found == pulls_.end() && pulls_.size() == kMaxPulls)
    return {Refusal::kFull, std::to_string(kMaxPulls) + " bodies are pulled already"};
  if (found != pulls_.end()) {
    *found = pull;
  } else {
    pulls_.push_back(pull);
    std::ranges::sort(pulls_, {}, &Pull::body);
  }
  tell(now(), recording::PullBody{pull.body.value,
                                  {pull.p_B.x(), pull.p_B.y(), pull.p_B.z()},
                                  {pull.target_W.x(), pull.target_W.y(), pull.target_W.z()},
                                  pull.max_force_n,
                                  pull.until_tick});
  return {};
}

bool Simulation::release(world::BodyId body) {
  if (std::erase_if(pulls_, [body](const Pull& pull) { return pull.body == body; }) == 0) return false;
  tell(now(), recording::ReleaseBody{body.value});
  return true;
}

void Simulation::release_all_of(std::uint64_t owner) {
  for (std::size_t i = pulls_.size(); i-- > 0;)
    if (pulls_[i].owner == owner) release(pulls_[i].body);
}

void Simulation::save_pulls(hwparts::StateWriter& to) const {
  to.put(static_cast<std::uint64_t>(pulls_.size()));
  for (const auto& pull : pulls_) {
    to.put(pull.body.value);
    to.put(std::span<const double>(pull.p_B.data(), 3));
    to.put(std::span<const double>(pull.target_W.data(), 3));
    to.put(pull.max_force_n);
    to.put(pull.until_tick);
  }
}

void Simulation::load_pulls(hwparts::StateReader& from) {
  std::uint64_t count = 0;
  from.get(count);
  if (count > kMaxPulls) throw std::out_of_range("more pulls than can act at once");
  pulls_.resize(count);
  for (auto& pull : pulls_) {
    from.get(pull.body.value);
    if (!pull.body.valid() || pull.body.index() >= state_.bodies.size())
      throw std::out_of_range("a pull of no body");
    from.get(std::span<double>(pull.p_B.data(), 3));
    from.get(std::span<double>(pull.target_W.data(), 3));
    from.get(pull.max_force_n);
    from.get(pull.until_tick);
    const auto& body = model().bodies[pull.body.index()];
    if (body.fixed || body.kinematic || !pull.p_B.allFinite() || !pull.target_W.allFinite() ||
        !(pull.max_force_n > 0.0))
      throw std::out_of_range("a pull that no world takes");
  }
}

}  // namespace visum::cycle
