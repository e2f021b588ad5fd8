#include "server/cycle/body_change.h"

#include <algorithm>
#include <utility>

#include "server/cycle/attempt.h"
#include "server/cycle/world_edit.h"

namespace visum::cycle {
namespace {

void take(BodyChange& change, scene::Scene changed) {
  auto kept = std::make_shared<const scene::Scene>(std::move(changed));
  change.machinery = make_machinery(*kept, change.sensors);
  change.changed = std::move(kept);
}

Outcome prepare_coming(BodyChange& change) {
  return attempt(Refusal::kBadValue, [&] {
    auto changed = *change.scene;
    scene::add_body(changed, change.edit.text);
    change.came = world::initial_state(changed.world).bodies.back();
    take(change, std::move(changed));
  });
}

Outcome prepare_going(BodyChange& change) {
  const auto& world = change.scene->world;
  const auto& name = change.edit.text;
  const auto body = change.gone = world.find_body(name);
  if (!body.valid()) return unknown_body(world, name);
  if (auto outcome = can_remove(world, body); !outcome.done()) return outcome;
  for (const auto& sensor : change.scene->sensors)
    if (sensor.body == body)
      return {Refusal::kWrongState, "'" + name + "' carries the sensor '" + sensor.name + "'"};
  return attempt(Refusal::kWrongState, [&] {
    auto changed = *change.scene;
    erase_body(changed.world, body);
    for (auto& sensor : changed.sensors)
      if (sensor.body > body) --sensor.body.value;
    take(change, std::move(changed));
  });
}

Outcome prepare_reset(BodyChange& change) {
  if (!change.original) return {};
  return attempt(Refusal::kWrongState, [&] {
    const auto& world = change.original->world;
    for (const auto& body : world.bodies) {
      const bool came = std::ranges::find(change.spawned, body.name) != change.spawned.end();
      change.kept.push_back(came ? world::BodyId{} : change.scene->world.find_body(body.name));
    }
    change.initial = world::initial_state(world).bodies;
    change.machinery = make_machinery(*change.original, change.sensors);
    change.changed = change.original;
  });
}

}  // namespace

Outcome prepare(BodyChange& change) {
  if (change.reset) return prepare_reset(change);
  return change.edit.came ? prepare_coming(change) : prepare_going(change);
}

}  // namespace visum::cycle
