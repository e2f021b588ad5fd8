// Rays per second on one core: a fan of a full circle, through the arm's cell and onto a mesh of many
// triangles. Also the time to place a world that has moved.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "server/scene/scene.h"
#include "server/sensing/painter.h"
#include "server/sensing/ray_world.h"

namespace visum::bench {
namespace {

constexpr int kRays = 3600;

world::WorldModel arm_cell() {
  return scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml").world;
}

// A ball of 5 m around the origin, with 2 n² triangles. Rays from inside hit it everywhere.
world::WorldModel ball_of_triangles(std::uint32_t n) {
  world::WorldModel model;
  world::TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      const double up = std::numbers::pi * i / n, around = 2 * std::numbers::pi * j / n;
      mesh.vertices.emplace_back(5 * std::sin(up) * std::cos(around), 5 * std::sin(up) * std::sin(around),
                                 5 * std::cos(up));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({b, b + 1, a + 1});
    }
  }
  model.meshes.push_back(std::move(mesh));
  world::Body body;
  body.name = "ball";
  body.fixed = true;
  model.bodies.push_back(body);
  world::Shape shape;
  shape.body = {0};
  shape.kind = world::ShapeKind::kMesh;
  shape.mesh = {0};
  model.shapes.push_back(shape);
  return model;
}

void cast_fans(benchmark::State& state, const world::WorldModel& model, const Eigen::Vector3d& from) {
  sensing::RayWorld rays(model);
  rays.place(world::initial_state(model));
  std::int64_t hits = 0, cast = 0;
  for (auto _ : state) {
    for (int i = 0; i < kRays; ++i) {
      const double angle = 2 * std::numbers::pi * i / kRays;
      const Eigen::Vector3d direction(std::cos(angle), std::sin(angle), -0.1);
      hits += rays.cast({from, direction.normalized(), 100.0, {}}).shape.valid();
      ++cast;
    }
  }
  state.counters["rays_per_second"] =
      benchmark::Counter(static_cast<double>(cast), benchmark::Counter::kIsRate);
  state.counters["share_that_hits"] = static_cast<double>(hits) / static_cast<double>(cast);
}

void rays_in_cell(benchmark::State& state) {
  cast_fans(state, arm_cell(), {0.2, 0.3, 0.5});
}
BENCHMARK(rays_in_cell)->Name("Rays/arm_cell")->Unit(benchmark::kMillisecond);

void rays_on_triangles(benchmark::State& state) {
  const auto n = static_cast<std::uint32_t>(state.range(0));
  cast_fans(state, ball_of_triangles(n), {0.2, 0.3, 0.5});
  state.counters["triangles"] = 2.0 * n * n;
}
BENCHMARK(rays_on_triangles)->Name("Rays/mesh")->Arg(22)->Arg(224)->Unit(benchmark::kMillisecond);

// A picture of the arm's cell; the argument is its width, at 4:3.
void paint(benchmark::State& state, sensors::Shows shows) {
  const auto scene =
      scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
  sensors::CameraSettings settings;
  settings.shows = shows;
  settings.lens = {static_cast<int>(state.range(0)), static_cast<int>(state.range(0)) * 3 / 4, 1.2};
  settings.farthest_m = 20.0;
  const auto now = world::initial_state(scene.world);
  sensing::Mount mount;
  mount.X_BS = {{-1.2, -1.2, 1.2},
                Eigen::Quaterniond(Eigen::AngleAxisd(0.785, Eigen::Vector3d::UnitZ())) *
                    Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()))};
  sensing::Painter painter(scene, mount, settings);
  std::vector<double> reading(1 + 7 * now.bodies.size());
  sensing::Painter::read({scene.world, now, now, {}, {}, 1e-3, nullptr}, reading);
  reading[0] = 1.0;
  std::vector<std::byte> image(sensors::image_bytes(settings));
  for (auto _ : state) painter.paint(reading, image);
  state.counters["frames_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
void paint_color(benchmark::State& state) {
  paint(state, sensors::Shows::kColor);
}
void paint_depth(benchmark::State& state) {
  paint(state, sensors::Shows::kDepth);
}
BENCHMARK(paint_color)->Name("Camera/color")->Arg(160)->Arg(320)->Arg(640)->Unit(benchmark::kMillisecond);
BENCHMARK(paint_depth)->Name("Camera/depth")->Arg(160)->Arg(320)->Arg(640)->Unit(benchmark::kMillisecond);

// All bodies that can move have moved, as before each tick in which a sensor is due.
void place_cell(benchmark::State& state) {
  const auto model = arm_cell();
  sensing::RayWorld rays(model);
  auto now = world::initial_state(model);
  rays.place(now);
  for (auto _ : state) {
    for (std::size_t i = 0; i < now.bodies.size(); ++i)
      if (!model.bodies[i].fixed) now.bodies[i].p_WC.x() += 1e-9;
    rays.place(now);
  }
  state.counters["shapes"] = static_cast<double>(model.shapes.size());
}
BENCHMARK(place_cell)->Name("Rays/place_arm_cell")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace visum::bench
