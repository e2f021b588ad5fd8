// Ticks of worlds with 1 to 1000 driving carts, with each engine; and the time that scenes take to load.
#include <benchmark/benchmark.h>

#include <cmath>
#include <fstream>
#include <string>

#include "server/cycle/simulation.h"
#include "server/scene/answer_cache.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::bench {
namespace {

const std::string kModels = std::string(VISUM_SOURCE_DIR) + "/models/";

// In rows of ten, far enough apart to drive circles of 0.9 m without meeting.
// `engine`: as a scene says it.
std::string fleet(int carts, const std::string& engine) {
  return "visum: 1\nengine: " + engine + "\ninclude:\n- " + kModels + "scenes/hall.yaml\n- file: " + kModels +
         "cart/cart.yaml\n  repeat: " + std::to_string(carts) +
         "\n  parameters: {name: \"cart_${index}\"}\n"
         "  pose: {xyz: [\"${4 * floor(index / 10)}\", \"${4 * (index % 10)}\", 0]}\n";
}

// Wheels at 5 rad/s, steered so that all roll about one centre 0.9 m to the left.
void drive_circles(cycle::Simulation& simulation) {
  const std::vector<double> speeds{4.0, 6.0, 4.36, 6.31}, angles{0.464, 0.322};
  for (std::size_t cart = 0; cart < simulation.parts().size(); ++cart) {
    simulation.write_inputs(cart, 0, speeds);
    simulation.write_inputs(cart, speeds.size(), angles);
  }
}

void fleet_ticks(benchmark::State& state, const std::string& engine) {
  const test::TempFiles files;
  const auto file = files.write("fleet.yaml", fleet(static_cast<int>(state.range(0)), engine));
  cycle::Simulation simulation(scene::load_scene(file));
  drive_circles(simulation);
  const int warm_up = state.range(0) == 1000 ? 300 : 1000;  // 1000 carts take 30 s for a second
  for (int i = 0; i < warm_up; ++i) simulation.tick();
  const auto start = simulation.take_snapshot();
  const auto first = simulation.tick_count();
  for (auto _ : state) {
    simulation.tick();
    if (simulation.tick_count() < first + 2000) continue;
    state.PauseTiming();
    if (!simulation.restore_snapshot(start).done()) state.SkipWithError("the snapshot is gone");
    state.ResumeTiming();
  }
  if (simulation.frozen()) state.SkipWithError(simulation.fault().c_str());
  state.counters["ticks_per_s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(fleet_ticks, ode, std::string("ode"))
    ->Name("Fleet/ode")
    ->Arg(1)
    ->Arg(10)
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(fleet_ticks, ode - quick, std::string("{kind: ode, step: quick}"))
    ->Name("Fleet/ode-quick")
    ->Arg(1)
    ->Arg(10)
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(fleet_ticks, impulse, std::string("impulse"))
    ->Name("Fleet/impulse")
    ->Arg(1)
    ->Arg(10)
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kMicrosecond);

void load(benchmark::State& state, const std::filesystem::path& file) {
  for (auto _ : state) benchmark::DoNotOptimize(scene::load_scene(file));
}

void load_bodies(benchmark::State& state) {
  const test::TempFiles files;
  const auto file = files.write(
      "s.yaml", "visum: 1\nbodies:\n- name: box_${index}\n  repeat: " + std::to_string(state.range(0)) +
                    "\n  mass: 1\n  pose: {xyz: [\"${index}\", 0, 1]}\n"
                    "  shapes: [{box: [0.1, 0.2, 0.3]}]\n");
  load(state, file);
}
BENCHMARK(load_bodies)->Name("SceneLoad/bodies")->Arg(10)->Arg(1000)->Unit(benchmark::kMillisecond);

// A sphere of `rings` x 500 quads, two triangles each.
void write_mesh(const std::filesystem::path& file, int rings) {
  constexpr int kSides = 500;
  std::ofstream out(file);
  for (int ring = 0; ring <= rings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const double a = M_PI * (ring + 0.5) / (rings + 1), b = 2.0 * M_PI * side / kSides;
      out << "v " << std::sin(a) * std::cos(b) << ' ' << std::sin(a) * std::sin(b) << ' ' << std::cos(a)
          << '\n';
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const int i = ring * kSides + side + 1, j = ring * kSides + (side + 1) % kSides + 1;
      out << "f " << i << ' ' << i + kSides << ' ' << j + kSides << ' ' << j << '\n';
    }
  }
}

void load_mesh(benchmark::State& state) {
  const test::TempFiles files;
  write_mesh(files.folder() / "m.obj", 100);
  const auto file =
      files.write("s.yaml", "visum: 1\nbodies: [{name: m, fixed: true, shapes: [{mesh: m.obj}]}]\n");
  load(state, file);
  state.counters["triangles"] =
      static_cast<double>(scene::load_scene(file).world.meshes.at(0).triangles.size());
}
BENCHMARK(load_mesh)->Name("SceneLoad/mesh")->Unit(benchmark::kMillisecond);

// A ball of 12 x 24 quads, with a radius of its own, as Collada writes it.
std::string collada_ball(double radius) {
  constexpr int kRings = 12, kSides = 24;
  std::string points, corners;
  for (int ring = 0; ring <= kRings; ++ring)
    for (int side = 0; side < kSides; ++side) {
      const double a = M_PI * (ring + 0.5) / (kRings + 1), b = 2.0 * M_PI * side / kSides;
      for (const double x : {std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)})
        points += std::to_string(radius * x) + " ";
    }
  for (int ring = 0; ring < kRings; ++ring)
    for (int side = 0; side < kSides; ++side) {
      const int i = ring * kSides + side, j = ring * kSides + (side + 1) % kSides;
      for (const int corner : {i, i + kSides, j + kSides, i, j + kSides, j})
        corners += std::to_string(corner) + " ";
    }
  const int vertices = (kRings + 1) * kSides;
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
         "<asset><unit meter='1'/></asset><library_geometries><geometry id='g'><mesh><source id='s'>"
         "<float_array id='a' count='" +
         std::to_string(3 * vertices) + "'>" + points +
         "</float_array><technique_common><accessor source='#a' count='" + std::to_string(vertices) +
         "' stride='3'><param name='X' type='float'/><param name='Y' type='float'/>"
         "<param name='Z' type='float'/></accessor></technique_common></source><vertices id='v'>"
         "<input semantic='POSITION' source='#s'/></vertices><triangles count='" +
         std::to_string(2 * kRings * kSides) + "'><input semantic='VERTEX' source='#v' offset='0'/><p>" +
         corners +
         "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='x'>"
         "<node><instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url='#x'/></scene></COLLADA>";
}

// A robot of 24 links, each with a Collada file that is seen and collides. `kept`: a first run converted
// them.
void load_robot(benchmark::State& state, bool kept) {
  const test::TempFiles files;
  std::string robot = "<robot name='r'>";
  for (int i = 0; i < 24; ++i) {
    const std::string number = std::to_string(i);
    files.write(number + ".dae", collada_ball(0.1 + 0.001 * i));
    const std::string mesh = "<geometry><mesh filename='" + number + ".dae'/></geometry>";
    robot += "<link name='l" + number + "'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' " +
             "izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial><visual>" + mesh + "</visual><collision>" +
             mesh + "</collision></link>";
    if (i > 0)
      robot += "<joint name='j" + number + "' type='continuous'><parent link='l" + std::to_string(i - 1) +
               "'/><child link='l" + number + "'/><origin xyz='0 0 0.5'/><axis xyz='1 0 0'/></joint>";
  }
  const auto file = files.write("r.urdf", robot + "</robot>");
  const auto cache = files.folder() / "cache";
  scene::keep_answers_in(kept ? cache : std::filesystem::path());
  scene::load_scene(file);
  if (kept && !std::filesystem::exists(cache)) state.SkipWithError("nothing was kept");
  for (auto _ : state) cycle::Simulation simulation(scene::load_scene(file));
  scene::keep_answers_in({});
}
BENCHMARK_CAPTURE(load_robot, first, false)
    ->Name("SceneLoad/robot/first")
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(load_robot, kept, true)
    ->Name("SceneLoad/robot/kept")
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void load_carts(benchmark::State& state) {
  const test::TempFiles files;
  load(state, files.write("fleet.yaml", fleet(static_cast<int>(state.range(0)), "ode")));
}
BENCHMARK(load_carts)->Name("SceneLoad/carts")->Arg(1)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace visum::bench
