#include <algorithm>
#include <queue>

#include "server/scene/joints.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

using world::Joint;

// The joint that carries each body (the first with the body as its child); -1: none.
std::vector<int> carrying_joints(const world::WorldModel& world) {
  std::vector<int> carrying(world.bodies.size(), -1);
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    int& joint = carrying[world.joints[i].child.index()];
    if (joint < 0 && world::carries(world.joints[i].kind)) joint = static_cast<int>(i);
  }
  return carrying;
}

// For each joint, the joints that must come after it: those that start from its child, and those that close a
// loop on it.
struct Order {
  std::vector<std::vector<int>> followers;
  std::vector<int> waits_for;  // number of joints that must come first
};

Order required_order(const world::WorldModel& world) {
  const std::vector<int> carrying = carrying_joints(world);
  Order order{std::vector<std::vector<int>>(world.joints.size()), std::vector<int>(world.joints.size(), 0)};
  const auto require = [&](int first, std::size_t then) {
    if (first < 0 || first == static_cast<int>(then)) return;
    order.followers[static_cast<std::size_t>(first)].push_back(static_cast<int>(then));
    ++order.waits_for[then];
  };
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    const Joint& joint = world.joints[i];
    if (joint.parent.valid()) require(carrying[joint.parent.index()], i);
    require(carrying[joint.child.index()], i);
  }
  return order;
}

// Names a cycle. The joints that are left over wait for a cycle but need not be part of it. Walking up long
// enough ends in the cycle itself.
[[noreturn]] void fail_cycle(const world::WorldModel& world, const Order& order, const config::Place& place) {
  const auto stuck = [&](int joint) {
    return joint >= 0 && order.waits_for[static_cast<std::size_t>(joint)] > 0;
  };
  const std::vector<int> carrying = carrying_joints(world);
  int joint = 0;
  while (!stuck(joint)) ++joint;
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    const Joint& here = world.joints[static_cast<std::size_t>(joint)];
    const int above = here.parent.valid() ? carrying[here.parent.index()] : -1;
    joint = stuck(above) ? above : carrying[here.child.index()];
  }
  throw config::ConfigError(place, "joint '" + world.joints[static_cast<std::size_t>(joint)].name +
                                       "' hangs below itself: its parents form a cycle");
}

// Kahn's topological sort. Among the joints that may come next, the earliest in the files does.
void sort_joints(world::WorldModel& world, const config::Place& place) {
  Order order = required_order(world);
  std::priority_queue<int, std::vector<int>, std::greater<>> ready;  // the smallest number first
  for (std::size_t i = 0; i < world.joints.size(); ++i)
    if (order.waits_for[i] == 0) ready.push(static_cast<int>(i));
  std::vector<Joint> sorted;
  while (!ready.empty()) {
    const auto joint = static_cast<std::size_t>(ready.top());
    ready.pop();
    sorted.push_back(world.joints[joint]);
    for (const int next : order.followers[joint])
      if (--order.waits_for[static_cast<std::size_t>(next)] == 0) ready.push(next);
  }
  if (sorted.size() < world.joints.size()) fail_cycle(world, order, place);
  world.joints = std::move(sorted);
}

}  // namespace

void read_no_collision(Draft& draft, const config::Node& list, const std::string& prefix) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const config::Node pair = list.at(i);
    if (pair.size() != 2) pair.fail("must be two bodies, has " + std::to_string(pair.size()));
    const LinkFrame a = draft.link(pair.at(0), prefix), b = draft.link(pair.at(1), prefix);
    draft.forbid_collision(a.body, b.body);
  }
}

void sort_world(Draft& draft, const config::Place& place) {
  sort_joints(draft.scene.world, place);
  auto& pairs = draft.scene.world.no_collision;
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

}  // namespace visum::scene
