// The collision stage alone, with our broad and narrow phase and with FCL's. On the arm's scene everything
// that can move goes to and fro at 1 m/s, because our stage hardly looks at shapes that do not move. The 1000
// boxes lie on a plane, in layers of 100, each a little in the one below, at rest or all falling by 1 um to
// and fro.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "server/collision/collision.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"

namespace visum::bench {
namespace {

world::CollisionKind stage_of(bool fcl) {
  return fcl ? world::CollisionKind::kFcl : world::CollisionKind::kVisum;
}

// Alternates between two states of a world.
void find_in(benchmark::State& state, const world::WorldModel& model, const world::WorldState& start,
             const world::WorldState& moved) {
  collision::CollisionStage stage(model);
  std::vector<collision::Contact> contacts;
  bool away = false;
  for (auto _ : state) {
    away = !away;
    stage.find(away ? moved : start, contacts);
  }
  state.counters["contacts"] = static_cast<double>(contacts.size());
}

void find_contacts(benchmark::State& state, bool fcl) {
  auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
  scene.world.collision_stage = stage_of(fcl);
  const auto start = world::initial_state(scene.world);
  auto moved = start;
  for (std::size_t i = 0; i < moved.bodies.size(); ++i)
    if (!scene.world.bodies[i].fixed)
      moved.bodies[i].p_WC.x() += 1e-9 * static_cast<double>(scene.world.tick_ns);
  find_in(state, scene.world, start, moved);
}
BENCHMARK_CAPTURE(find_contacts, visum, false)->Name("Collision/arm")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(find_contacts, fcl, true)->Name("Collision/arm/fcl")->Unit(benchmark::kMicrosecond);

world::WorldModel boxes() {
  constexpr double kSide = 0.1, kGap = 0.15;
  world::WorldModel model;
  model.engines.push_back({"impulse"});
  model.surfaces.push_back({"default"});
  const auto add = [&](world::ShapeKind kind, const std::array<double, 3>& size, const Eigen::Vector3d& p) {
    const world::BodyId id{static_cast<std::int32_t>(model.bodies.size())};
    world::Body& body = model.bodies.emplace_back();
    body.name = "body_" + std::to_string(id.value);
    body.fixed = kind == world::ShapeKind::kPlane;
    body.mass_kg = body.fixed ? 0.0 : 1.0;
    body.inertia_C = body.mass_kg / 600.0 * Eigen::Matrix3d::Identity();
    body.X_WB.p = p;
    world::Shape& shape = model.shapes.emplace_back();
    shape.body = id;
    shape.kind = kind;
    shape.size = size;
    shape.surface = {0};
  };
  add(world::ShapeKind::kPlane, {}, Eigen::Vector3d::Zero());
  for (int i = 0; i < 1000; ++i)
    add(world::ShapeKind::kBox, {kSide, kSide, kSide},
        {kGap * (i % 10), kGap * (i / 10 % 10), (i / 100 + 0.5) * kSide - 1e-5 * (i / 100 + 1)});
  return model;
}

void find_in_boxes(benchmark::State& state, bool fcl, double moved_m) {
  world::WorldModel model = boxes();
  model.collision_stage = stage_of(fcl);
  const auto start = world::initial_state(model);
  auto moved = start;
  for (std::size_t i = 1; i < moved.bodies.size(); ++i) moved.bodies[i].p_WC.z() -= moved_m;
  find_in(state, model, start, moved);
}
BENCHMARK_CAPTURE(find_in_boxes, rest, false, 0.0)
    ->Name("Collision/boxes1000/rest")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(find_in_boxes, visum, false, 1e-6)
    ->Name("Collision/boxes1000")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(find_in_boxes, fcl, true, 1e-6)
    ->Name("Collision/boxes1000/fcl")
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace visum::bench
