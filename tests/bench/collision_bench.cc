// The collision stage alone, on the arm's scene. Everything that can move goes to and fro at 1 m/s, because
// the stage hardly looks at shapes that do not move.
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
  auto moved = start;
  for (std::size_t i = 0; i < moved.bodies.size(); ++i)
    if (!scene.world.bodies[i].fixed)
      moved.bodies[i].p_WC.x() += 1e-9 * static_cast<double>(scene.world.tick_ns);
  collision::CollisionStage stage(scene.world);
  std::vector<collision::Contact> contacts;
  bool away = false;
  for (auto _ : state) {
    away = !away;
    stage.find(away ? moved : start, contacts);
  }
  state.counters["contacts"] = static_cast<double>(contacts.size());
}
BENCHMARK(find_contacts)->Name("Collision/arm")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace visum::bench
