// The collision stage alone, on the arm's scene.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "server/collision/collision.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"

namespace visum::bench {
namespace {

void find_contacts(benchmark::State& state) {
  const auto scene =
      scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
  const auto start = world::initial_state(scene.world);
  collision::CollisionStage stage(scene.world);
  std::vector<collision::Contact> contacts;
  for (auto _ : state) stage.find(start, contacts);
  state.counters["contacts"] = static_cast<double>(contacts.size());
}
BENCHMARK(find_contacts)->Name("Collision/arm")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace visum::bench
