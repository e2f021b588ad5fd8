#include "server/cycle/world_edit.h"

#include <algorithm>

namespace visum::cycle {

std::string why_not_removable(const world::WorldModel& model, world::BodyId body) {
  const auto& name = model.bodies[body.index()].name;
  if (!model.bodies[body.index()].model.empty()) return "'" + name + "' belongs to a model";
  for (const auto& joint : model.joints)
    if (joint.parent == body || joint.child == body)
      return "the joint '" + joint.name + "' holds '" + name + "'";
  return {};
}

void erase_body(world::WorldModel& model, world::BodyId body) {
  const auto close_gap = [body](world::BodyId& id) {
    if (id > body) --id.value;
  };
  model.bodies.erase(model.bodies.begin() + body.value);
  std::erase_if(model.shapes, [body](const auto& shape) { return shape.body == body; });
  std::erase_if(model.no_collision,
                [body](const auto& pair) { return pair.first == body || pair.second == body; });
  for (auto& shape : model.shapes) close_gap(shape.body);
  for (auto& joint : model.joints) {
    close_gap(joint.parent);
    close_gap(joint.child);
  }
  for (auto& [a, b] : model.no_collision) {
    close_gap(a);
    close_gap(b);
  }
}

}  // namespace visum::cycle
