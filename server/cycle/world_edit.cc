#include "server/cycle/world_edit.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "protocol/config/unknown_name.h"

namespace visum::cycle {

Outcome unknown_body(const world::WorldModel& model, const std::string& name) {
  std::vector<std::string> known;
  for (const auto& body : model.bodies) known.push_back(body.name);
  return {Refusal::kUnknownName, config::unknown_name("body", name, known)};
}

Outcome can_remove(const world::WorldModel& model, world::BodyId body) {
  const auto& name = model.bodies[body.index()].name;
  if (!model.bodies[body.index()].model.empty())
    return {Refusal::kWrongState, "'" + name + "' belongs to a model"};
  for (const auto& joint : model.joints)
    if (joint.parent == body || joint.child == body)
      return {Refusal::kWrongState, "the joint '" + joint.name + "' holds '" + name + "'"};
  return {};
}

namespace {

// Erases those of the candidates that no shape uses any more. From the back, so that those before keep their
// numbers.
void erase_meshes(world::WorldModel& model, std::vector<world::MeshId> candidates) {
  std::ranges::sort(candidates, std::greater<>());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  for (const world::MeshId mesh : candidates) {
    if (std::ranges::find(model.shapes, mesh, &world::Shape::mesh) != model.shapes.end()) continue;
    model.meshes.erase(model.meshes.begin() + mesh.value);
    for (auto& shape : model.shapes)
      if (shape.mesh > mesh) --shape.mesh.value;
  }
}

}  // namespace

void erase_body(world::WorldModel& model, world::BodyId body) {
  const auto close_gap = [body](world::BodyId& id) {
    if (id > body) --id.value;
  };
  std::vector<world::MeshId> meshes;
  for (const auto& shape : model.shapes)
    if (shape.body == body && shape.mesh.valid()) meshes.push_back(shape.mesh);
  model.bodies.erase(model.bodies.begin() + body.value);
  std::erase_if(model.shapes, [body](const auto& shape) { return shape.body == body; });
  std::erase_if(model.no_collision,
                [body](const auto& pair) { return pair.first == body || pair.second == body; });
  erase_meshes(model, std::move(meshes));
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
