#include "server/cycle/body_change.h"

#include <algorithm>
#include <map>
#include <set>

#include "protocol/config/unknown_name.h"
#include "server/collision/prepared_meshes.h"
#include "server/cycle/attempt.h"
#include "server/cycle/start_overlaps.h"
#include "server/cycle/world_edit.h"

namespace visum::cycle {
namespace {

using Edit = recording::State::Edit;

// To the bit, so that the model stands where it stood. world::find_fault() refuses what is no rotation.
world::Pose pose_of(const recording::SpawnedModel& model) {
  const auto& [x, y, z, qw, qx, qy, qz] = model.pose;
  return {{x, y, z}, Eigen::Quaterniond(qw, qx, qy, qz)};
}

// Its parts are made at once: they may read files, too.
void make_parts(BodyChange& change, const scene::Scene& scene) {
  const auto& model = scene.spawned.back();
  for (std::size_t i = scene.parts.size() - model.parts.size(); i < scene.parts.size(); ++i)
    change.parts.push_back(make_bound_part(scene, scene.parts[i], change.make));
  for (std::size_t i = scene.sensors.size() - model.sensors.size(); i < scene.sensors.size(); ++i)
    change.parts.push_back(make_bound_sensor(scene, scene.sensors[i]));
}

// Reads a model and makes its parts.
void bring(BodyChange& change, scene::Scene& scene, const scene::SpawnOrder& order) {
  scene::spawn(scene, order);
  const auto losses = scene.losses.size(), repairs = scene.repairs.size();
  scene = leave_out_overlaps(std::move(scene), *change.meshes);
  scene.repairs.resize(repairs);
  auto& told = scene.spawned.back().losses;
  told.insert(told.end(), scene.losses.begin() + static_cast<std::ptrdiff_t>(losses), scene.losses.end());
  make_parts(change, scene);
}

// Makes an edit of the model that was asked for, with everything that it was read from.
void bring_ordered(BodyChange& change, scene::Scene& scene) {
  auto model = std::make_shared<recording::SpawnedModel>();
  const auto& order = *change.order;
  if (change.given) {
    const config::FilesGiven files(*change.given);
    bring(change, scene, order);
    model->files = std::move(*change.given);
  } else {
    config::FilesNoted noted;
    bring(change, scene, order);
    model->files = std::move(noted.files);
  }
  const auto& [p, q] = order.X_WM;
  model->file = std::filesystem::absolute(order.file).lexically_normal().string();
  model->name = scene.spawned.back().name;
  model->pose = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
  change.noted.push_back({{Edit::Kind::kModelCame, {}, model}, model->name});
}

Outcome take_body(scene::Scene& scene, const std::string& name) {
  const auto body = scene.world.find_body(name);
  if (!body.valid()) return unknown_body(scene.world, name);
  for (const auto& model : scene.spawned)
    if (std::ranges::find(model.bodies, name) != model.bodies.end())
      return {Refusal::kWrongState,
              "'" + name + "' came with the model '" + model.name + "', which goes as a whole"};
  if (auto outcome = can_remove(scene.world, body); !outcome.done()) return outcome;
  for (const auto& sensor : scene.sensors)
    if (sensor.body == body)
      return {Refusal::kWrongState, "'" + name + "' carries the sensor '" + sensor.name + "'"};
  return attempt(Refusal::kWrongState, [&] {
    erase_body(scene.world, body);
    for (auto& sensor : scene.sensors)
      if (sensor.body > body) --sensor.body.value;
  });
}

Outcome take_model(scene::Scene& scene, const std::string& name) {
  const auto model = std::ranges::find(scene.spawned, name, &scene::Spawned::name);
  if (model != scene.spawned.end())
    return attempt(Refusal::kWrongState, [&] { erase_spawned(scene, *model); });
  if (std::ranges::find(scene.models, name, &scene::ModelPlan::name) != scene.models.end())
    return {Refusal::kWrongState,
            "'" + name + "' belongs to the scene: only models that were spawned can go"};
  std::vector<std::string> known;
  for (const auto& other : scene.spawned) known.push_back(other.name);
  return {Refusal::kUnknownName, config::unknown_name("spawned model", name, known)};
}

Outcome make_edit(BodyChange& change, scene::Scene& scene, const Edit& edit) {
  Outcome outcome;
  std::string came;
  switch (edit.kind) {
    case Edit::Kind::kBodyCame:
      outcome = attempt(Refusal::kBadValue, [&] {
        scene::add_body(scene, edit.text);
        came = scene.world.bodies.back().name;
      });
      break;
    case Edit::Kind::kBodyWent:
      outcome = take_body(scene, edit.text);
      break;
    case Edit::Kind::kModelCame:
      outcome = attempt(Refusal::kBadValue, [&] {
        const config::FilesGiven files(edit.model->files);
        bring(change, scene, {edit.model->file, edit.model->name, pose_of(*edit.model)});
        came = edit.model->name;
      });
      break;
    case Edit::Kind::kModelWent:
      outcome = take_model(scene, edit.text);
      break;
  }
  if (outcome.done()) change.noted.push_back({edit, std::move(came)});
  return outcome;
}

// Names of bodies that are others than those of the same name in `scene`.
std::set<std::string> new_bodies(const BodyChange& change) {
  std::set<std::string> names;
  if (change.base == change.scene) return names;
  names.insert(change.came.begin(), change.came.end());
  for (const auto& model : change.scene->spawned) names.insert(model.bodies.begin(), model.bodies.end());
  return names;
}

template <typename Id, typename List>
std::vector<Id> kept_of(const List& now, const List& before, const std::set<std::string>& others) {
  std::map<std::string_view, Id> known;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!others.contains(before[i].name)) known.emplace(before[i].name, Id{static_cast<std::int32_t>(i)});
  std::vector<Id> kept;
  for (const auto& one : now) {
    const auto found = known.find(one.name);
    kept.push_back(found == known.end() ? Id{} : found->second);
  }
  return kept;
}

std::vector<sensors::Sensor*> sensors_of(const BodyChange& change) {
  std::map<std::string_view, sensors::Sensor*> known;
  for (const auto& bound : change.parts)
    if (auto* sensor = sensor_of(bound)) known.emplace(sensor->description().name, sensor);
  for (const auto& [name, sensor] : change.sensors) known.emplace(name, sensor);
  std::vector<sensors::Sensor*> measured;
  PixelBudget budget;
  for (const auto& plan : change.changed->sensors) {
    measured.push_back(known.at(plan.name));
    budget.take(*measured.back(), plan);
  }
  return measured;
}

// Everything that is made of the changed scene.
void complete(BodyChange& change) {
  const auto& now = change.changed->world;
  const auto& before = change.scene->world;
  const auto others = new_bodies(change);
  change.kept = kept_of<world::BodyId>(now.bodies, before.bodies, others);
  std::set<std::string> other_joints;
  if (change.base != change.scene)
    for (const auto& model : change.scene->spawned)
      other_joints.insert(model.joints.begin(), model.joints.end());
  change.kept_joints = kept_of<world::JointId>(now.joints, before.joints, other_joints);
  change.initial = world::initial_state(now);
  change.measured = sensors_of(change);
  change.machinery = make_machinery(*change.changed, change.measured, *change.meshes);
  change.machinery.ring->take_over(*change.ring, change.tick, change.kept_joints, change.kept);
  if (may_make_engines(*change.changed)) change.machinery.engines = make_engines(*change.changed);
}

Outcome make_ready(BodyChange& change) {
  scene::Scene changed;
  auto outcome = attempt(Refusal::kWrongState, [&] { changed = *change.base; });
  for (const auto& edit : change.edits)
    if (outcome.done()) outcome = make_edit(change, changed, edit);
  if (outcome.done() && change.order)
    outcome = attempt(Refusal::kBadValue, [&] { bring_ordered(change, changed); });
  if (!outcome.done()) return outcome;
  const bool comes = change.order || std::ranges::any_of(change.edits, [](const Edit& edit) {
                       return edit.kind == Edit::Kind::kBodyCame || edit.kind == Edit::Kind::kModelCame;
                     });
  return attempt(comes ? Refusal::kBadValue : Refusal::kWrongState, [&] {
    change.changed = std::make_shared<const scene::Scene>(std::move(changed));
    complete(change);
  });
}

}  // namespace

bool BodyChange::keeps(const scene::Spawned& model) const {
  return base == scene &&
         std::ranges::find(scene->spawned, model.name, &scene::Spawned::name) != scene->spawned.end();
}

Outcome prepare(BodyChange& change) {
  if (!change.base) return {};
  change.meshes->forget_unused();  // what has gone since the last change
  const auto outcome = make_ready(change);
  if (!outcome.done()) change.meshes->forget_unused();
  return outcome;
}

}  // namespace visum::cycle
