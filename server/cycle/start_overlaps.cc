#include "server/cycle/start_overlaps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "protocol/config/number_text.h"
#include "server/collision/collision.h"
#include "server/world/world_state.h"

namespace visum::cycle {
namespace {

using scene::ModelPlan;

constexpr std::size_t kMaxNamed = 8;  // pairs in the text of a repair
// A tick has a greatest number of contacts. Where more overlap, pairs are left out in several rounds.
constexpr int kMaxRounds = 8;

bool asks_for_it(const ModelPlan& model) {
  return model.overlaps_never_collide;
}

// In whole micrometres.
std::string rounded(double depth_m) {
  return config::number_text(std::round(depth_m * 1e6) / 1e6);
}

scene::FileRemark repair_of(const scene::Scene& scene, const ModelPlan& model,
                            const std::vector<Overlap>& overlaps) {
  std::string text = "model '" + model.name + "': links that overlap at the start never collide:";
  const std::size_t named = std::min(overlaps.size(), kMaxNamed);
  for (std::size_t i = 0; i < named; ++i)
    text += (i == 0 ? " '" : ", '") + scene.world.bodies[overlaps[i].a.index()].name + "' and '" +
            scene.world.bodies[overlaps[i].b.index()].name + "' (" + rounded(overlaps[i].depth_m) + " m)";
  if (overlaps.size() > named) text += ", and " + std::to_string(overlaps.size() - named) + " more";
  return {model.file, {text, 0}};
}

// Returns the overlaps within each model that asks for it, by the model's number.
std::map<std::size_t, std::vector<Overlap>> overlaps_of_models(const scene::Scene& scene,
                                                               collision::PreparedMeshes& meshes) {
  std::map<std::size_t, std::vector<Overlap>> found;
  for (const Overlap& overlap : overlaps_at_start(scene.world, meshes)) {
    const std::string& name = scene.world.bodies[overlap.a.index()].model;
    if (name != scene.world.bodies[overlap.b.index()].model) continue;
    const auto model = std::ranges::find(scene.models, name, &ModelPlan::name);
    if (model != scene.models.end() && asks_for_it(*model))
      found[static_cast<std::size_t>(model - scene.models.begin())].push_back(overlap);
  }
  return found;
}

}  // namespace

std::vector<Overlap> overlaps_at_start(const world::WorldModel& model, collision::PreparedMeshes& meshes) {
  std::vector<collision::Contact> contacts;
  collision::CollisionStage(model, meshes).find(world::initial_state(model), contacts);
  std::map<std::pair<world::BodyId, world::BodyId>, double> deepest;
  for (const collision::Contact& contact : contacts) {
    if (contact.depth <= kLeastOverlap) continue;
    double& depth = deepest[std::minmax(contact.body_a, contact.body_b)];
    depth = std::max(depth, contact.depth);
  }
  std::vector<Overlap> overlaps;
  for (const auto& [pair, depth] : deepest) overlaps.push_back({pair.first, pair.second, depth});
  std::ranges::stable_sort(overlaps, std::greater<>(), &Overlap::depth_m);
  return overlaps;
}

scene::Scene leave_out_overlaps(scene::Scene scene, collision::PreparedMeshes& meshes) {
  if (std::ranges::none_of(scene.models, asks_for_it)) return scene;
  auto& pairs = scene.world.no_collision;
  for (int round = 0; round < kMaxRounds; ++round) {
    const auto found = overlaps_of_models(scene, meshes);
    if (found.empty()) break;
    for (const auto& [model, overlaps] : found) {
      for (const Overlap& overlap : overlaps) pairs.emplace_back(overlap.a, overlap.b);
      scene.repairs.push_back(repair_of(scene, scene.models[model], overlaps));
      scene.losses.push_back(scene.repairs.back().remark.text);
    }
    std::sort(pairs.begin(), pairs.end());
  }
  return scene;
}

}  // namespace visum::cycle
