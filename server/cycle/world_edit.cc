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

namespace {

// Where things stand once some are gone; invalid: it is gone itself.
template <typename Id>
class Renumbering {
 public:
  explicit Renumbering(const std::vector<bool>& gone) {
    std::int32_t next = 0;
    for (const bool is_gone : gone) now_.push_back(is_gone ? Id{} : Id{next++});
  }
  bool gone(Id id) const { return id.valid() && !now_[id.index()].valid(); }
  void renumber(Id& id) const {
    if (id.valid()) id = now_[id.index()];
  }

 private:
  std::vector<Id> now_;
};

template <typename List>
std::vector<bool> marks_of(const List& list, const std::vector<std::string>& gone) {
  std::vector<bool> marks;
  for (const auto& one : list) marks.push_back(std::ranges::find(gone, one.name) != gone.end());
  return marks;
}

template <typename List, typename Name>
void erase_named(List& list, const std::vector<std::string>& gone, const Name& name) {
  std::erase_if(list, [&](const auto& one) { return std::ranges::find(gone, name(one)) != gone.end(); });
}

void erase_bodies(world::WorldModel& world, const Renumbering<world::BodyId>& bodies,
                  const Renumbering<world::JointId>& joints) {
  std::vector<world::MeshId> meshes;
  for (const auto& shape : world.shapes)
    if (bodies.gone(shape.body) && shape.mesh.valid()) meshes.push_back(shape.mesh);
  const auto erase = [](auto& list, const auto& gone) {
    std::size_t number = 0;
    std::erase_if(list, [&](const auto&) { return gone(number++); });
  };
  erase(world.bodies, [&](std::size_t i) { return bodies.gone({static_cast<std::int32_t>(i)}); });
  erase(world.joints, [&](std::size_t i) { return joints.gone({static_cast<std::int32_t>(i)}); });
  std::erase_if(world.shapes, [&](const auto& shape) { return bodies.gone(shape.body); });
  std::erase_if(world.no_collision,
                [&](const auto& pair) { return bodies.gone(pair.first) || bodies.gone(pair.second); });
  erase_meshes(world, std::move(meshes));
  for (auto& shape : world.shapes) bodies.renumber(shape.body);
  for (auto& joint : world.joints) {
    bodies.renumber(joint.parent);
    bodies.renumber(joint.child);
  }
  for (auto& [a, b] : world.no_collision) {
    bodies.renumber(a);
    bodies.renumber(b);
  }
}

}  // namespace

void erase_spawned(scene::Scene& scene, const scene::Spawned& model) {
  const scene::Spawned gone = model;  // it is erased itself
  const Renumbering<world::BodyId> bodies(marks_of(scene.world.bodies, gone.bodies));
  const Renumbering<world::JointId> joints(marks_of(scene.world.joints, gone.joints));
  erase_named(scene.models, gone.models, [](const auto& one) { return one.name; });
  erase_named(scene.parts, gone.parts, [](const auto& one) { return one.context.name; });
  erase_named(scene.sensors, gone.sensors, [](const auto& one) { return one.name; });
  std::erase_if(scene.followers, [&](const auto& follower) { return joints.gone(follower.joint); });
  erase_bodies(scene.world, bodies, joints);
  for (auto& part : scene.parts)
    for (auto& joint : part.joints) joints.renumber(joint);
  for (auto& follower : scene.followers) {
    joints.renumber(follower.joint);
    joints.renumber(follower.leader);
  }
  for (auto& sensor : scene.sensors) {
    bodies.renumber(sensor.body);
    joints.renumber(sensor.joint);
  }
  for (const auto& loss : gone.losses)
    if (const auto told = std::ranges::find(scene.losses, loss); told != scene.losses.end())
      scene.losses.erase(told);
  std::erase_if(scene.spawned, [&](const auto& one) { return one.name == gone.name; });
}

}  // namespace visum::cycle
